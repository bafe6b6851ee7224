// Two results beside each other, number by number.

/** What says how long something took, and where. */
const NOT_COMPARED = new Set(["seconds", "time_taken_s", "duration_s"]);

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
 * How many values were compared, the largest deviation, and where it is. Numbers deviate by their difference over the largest number at
 * the same place, since one of a list may be zero but for rounding; probabilities by their difference alone, since small ones have few
 * digits; numbers of the search for consistent parameters count a thousandth, as it stops at a gap; anything else deviates
 * infinitely where it differs.
 */
export function compare(found, expected) {
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
  return largestOf(values) * (place.endsWith("smallest_eigenvalue") ? 1000 : 1);
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
export function deviationOfEstimates(found, expected) {
  if (found.verdict !== expected.verdict || found.runs.length !== expected.runs.length) return Infinity;
  const ofParameter = ({ name, estimate, standard_deviation: sigma }, other) => (name === other?.name ? Math.abs(estimate - other.estimate) / sigma : Infinity);
  const ofRun = ({ parameters }, run) => parameters.map((parameter, index) => ofParameter(parameter, found.runs[run].parameters[index]));
  return Math.max(...expected.runs.flatMap(ofRun));
}
