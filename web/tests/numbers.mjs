// Two results beside each other, number by number.

/** Relative difference of two numbers at most. */
const TOLERANCE = 1e-9;

/** Difference of two estimates at most, in standard deviations: twice the change at which iterations end. */
const TOLERANCE_IN_DEVIATIONS = 0.1;

/** What says how long something took, and where. */
const NOT_COMPARED = new Set(["seconds", "time_taken_s", "duration_s"]);

/** Results as text, without what says how long something took. */
export function textOf(results) {
  return JSON.stringify(results, (key, value) => (NOT_COMPARED.has(key) ? undefined : value));
}

/** The values of two results at the same places, whose names leave out the indices of lists. */
function* pairs(a, b, place = "") {
  const isList = Array.isArray(a) && Array.isArray(b) && a.length === b.length;
  const isObject = [a, b].every((value) => value !== null && typeof value === "object" && !Array.isArray(value));
  if (isList) {
    for (const index of a.keys()) yield* pairs(a[index], b[index], `${place}[]`);
  } else if (isObject) {
    const keys = new Set([...Object.keys(a), ...Object.keys(b)]);
    for (const key of keys) if (!NOT_COMPARED.has(key)) yield* pairs(a[key], b[key], `${place}.${key}`);
  } else {
    yield { place, a, b };
  }
}

/**
 * The differences of two results: of numbers without a simulation, and of all estimates in standard deviations. Where a simulation chooses
 * its steps, one that is accepted here and refused there is a difference of the integrator's tolerance, as between two processors of which
 * one has fused multiplication and addition: the command line gives up to 0.014 deviations on TX40. Where the record itself is simulated, only
 * `areNear` can be asked.
 */
export function differences(found, expected) {
  const [numbers, estimates] = [compare(ofMeasurement(found), ofMeasurement(expected)), deviationOfEstimates(found, expected)];
  const areNear = estimates <= TOLERANCE_IN_DEVIATIONS;
  return { ...numbers, estimates, areNear, areSame: areNear && numbers.worst.deviation <= TOLERANCE };
}

/** Results without the figures of simulations, and of the model, whose search stops at a gap: its values are compared as estimates. */
function ofMeasurement({ runs, advice, verdict_reasons: reasons, diagnostics: _, model: __, ...others }) {
  const measured = runs.filter(({ method }) => method === "idim-ls" || method === "idim-wls").map(withoutSimulation);
  return { ...others, runs: measured, taken: advice.map(({ take }) => take), reasons: reasons.map(({ code }) => code) };
}

function withoutSimulation({ simulation_relative_error_percent: _, validation_simulation_relative_error_percent: __, ...run }) {
  return run;
}

/**
 * How many values were compared, the largest deviation, and where it is. Numbers deviate by their difference over the largest number at
 * the same place, since one of a list may be zero but for rounding; probabilities by their difference alone, since small ones have few
 * digits; numbers of the search for consistent parameters count a thousandth, as it stops at a gap; anything else deviates
 * infinitely where it differs.
 */
function compare(found, expected) {
  const places = new Map();
  for (const pair of pairs(found, expected)) places.set(pair.place, [...(places.get(pair.place) ?? []), pair]);
  const deviations = [...places].flatMap(([place, values]) => {
    const scale = scaleOf(place, values);
    return values.map(({ a, b }) => ({ place, a, b, deviation: deviation(a, b, scale) }));
  });
  return { count: deviations.length, worst: deviations.reduce((most, one) => (one.deviation > most.deviation ? one : most), { deviation: 0 }) };
}

function scaleOf(place, values) {
  if (place.endsWith("p_value")) return 1;
  return largestOf(values) * (/\.physical\.|smallest_eigenvalue$/.test(place) ? 1000 : 1);
}

function largestOf(values) {
  const sizes = values.flatMap(({ a, b }) => [a, b]).filter((value) => typeof value === "number").map(Math.abs);
  return sizes.reduce((most, size) => Math.max(most, size), 0);
}

function deviation(a, b, scale) {
  if (a === b) return 0;
  return typeof a === "number" && typeof b === "number" ? Math.abs(a - b) / scale : Infinity;
}

/** The largest difference of two estimates of the same runs, in standard deviations; infinite where runs or verdicts differ. */
function deviationOfEstimates(found, expected) {
  if (found.verdict !== expected.verdict || found.runs.length !== expected.runs.length) return Infinity;
  const ofParameter = ({ name, estimate, standard_deviation: sigma }, other) => (name === other?.name ? Math.abs(estimate - other.estimate) / sigma : Infinity);
  const ofRun = ({ parameters }, run) => parameters.map((parameter, index) => ofParameter(parameter, found.runs[run].parameters[index]));
  return Math.max(...expected.runs.flatMap(ofRun), deviationOfModels(found.model, expected.model));
}

/** The largest difference of two values of the models, in the standard deviations of their intervals; infinite where one has no model. */
function deviationOfModels(found, expected) {
  if (!found || !expected) return found === expected || !(found ?? expected) ? 0 : Infinity;
  const ofParameter = ({ name, value, interval_95: interval }, index) => {
    const other = found.parameters[index];
    if (name !== other?.name) return Infinity;
    return value === other.value ? 0 : Math.abs(value - other.value) / ((interval[1] - interval[0]) / (2 * 1.96));
  };
  return Math.max(0, ...expected.parameters.map(ofParameter));
}
