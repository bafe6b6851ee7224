// Compares what the module gives in Node with what the command line gives, number by number, and the times of both with one core.
//
//   node web/compare.mjs PROGRAM [DATASETS [EXPERIMENT...]]
//
// Without DATASETS only the demonstration is compared. Exits with 1 where a number differs by more than 1e-9 of the largest of its
// kind: of all numbers in the same place of a list. What depends on a simulation with adaptive steps is compared by its estimates, in
// standard deviations: a step that is accepted here and refused there is a difference of the integrator's tolerance. So do two processors
// differ of which one has fused multiplication and addition: the command line gives up to 0.014 deviations on TX40.

import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { initSync, Session } from "./wasm/thetahat_web.js";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "..");
const TOLERANCE = 1e-9;
const TOLERANCE_IN_DEVIATIONS = 0.05;
/** Experiments whose simulations have adaptive steps; the demonstration's record is one of them. */
const ADAPTIVE = { demo: () => false, tx40_paper: (run) => run.method === "idim-ls" };
/** What says how long something took, and where. */
const NOT_COMPARED = new Set(["seconds", "time_taken_s", "duration_s"]);

const [program, datasets, ...chosen] = process.argv.slice(2);
const all = datasets ? ["demo", "emps", "kuka_lwr4", "ur10", "tx40_paper"] : ["demo"];

/** The names of the files that an experiment takes. */
const filesOf = (toml) => [...new Set([...toml.matchAll(/file = "([^"]+)"/g)].map((match) => match[1]))];

function put(session, experiment, toml) {
  for (const file of filesOf(toml)) session.put(file, readFileSync(join(datasets, file)));
  const robot = /^robot = "([^"]+)"/m.exec(toml)[1];
  const beside = join(ROOT, "experiments", robot);
  session.put(robot.replace("../", ""), readFileSync(existsSync(beside) ? beside : join(datasets, robot)));
  const published = /^published = "([^"]+)"/m.exec(toml)?.[1];
  if (published) session.put(published, readFileSync(join(ROOT, "experiments", published)));
}

/** The results and seconds of the module. */
function inPage(name, toml) {
  const session = new Session();
  if (name !== "demo") put(session, name, toml);
  const text = name === "demo" ? JSON.parse(session.demo()).experiment : toml;
  const start = performance.now();
  const answer = JSON.parse(session.identify(text, () => {}));
  return { results: JSON.parse(answer.files["results.json"]), seconds: (performance.now() - start) / 1000 };
}

/** The results and seconds of the command line, on one core. */
function onCommandLine(name) {
  const experiment = name === "demo" ? ["demo"] : ["identify", join(ROOT, "experiments", `${name}.toml`), "--data", datasets];
  const start = performance.now();
  let text;
  try {
    text = execFileSync("taskset", ["-c", "0", program, ...experiment, "--json"], { encoding: "utf8", maxBuffer: 1 << 30, stdio: ["ignore", "pipe", "ignore"] });
  } catch (error) {
    // Exit code 1: the numbers are not to be trusted, and are there.
    if (error.status !== 1) throw error;
    text = error.stdout;
  }
  return { results: JSON.parse(text), seconds: (performance.now() - start) / 1000 };
}

/** Every pair of numbers, by the place without the indices of lists; other values must be equal. */
function* pairs(a, b, place = "") {
  if (typeof a === "number" && typeof b === "number") yield { place, a, b };
  else if (Array.isArray(a) && Array.isArray(b) && a.length === b.length) for (const k in a) yield* pairs(a[k], b[k], `${place}[${a[k]?.method ? `${a[k].case ?? ""} ${a[k].method}` : ""}]`);
  else if (a && b && typeof a === "object" && typeof b === "object" && !Array.isArray(a)) {
    for (const key of new Set([...Object.keys(a), ...Object.keys(b)])) if (!NOT_COMPARED.has(key)) yield* pairs(a[key], b[key], `${place}.${key}`);
  } else if (a !== b) yield { place, a, b, differs: true };
}

/** The worst deviation, and a line for each place that deviates too much. */
function compare(name, a, b) {
  const places = new Map();
  for (const pair of pairs(a, b)) {
    if (!places.has(pair.place)) places.set(pair.place, []);
    places.get(pair.place).push(pair);
  }
  let [worst, count, where] = [0, 0, ""];
  for (const [place, found] of places) {
    // A probability is compared as it is: one of 1e-140 has fewer digits than the statistic that it is of.
    const largest = found.reduce((most, { a, b }) => Math.max(most, Math.abs(a) || 0, Math.abs(b) || 0), 0);
    const scale = place.endsWith("p_value") ? 1 : largest;
    const deviation = ({ a, b, differs }) => (differs ? Infinity : a === b ? 0 : Math.abs(a - b) / scale);
    const most = found.reduce((far, pair) => (deviation(pair) > deviation(far) ? pair : far));
    count += found.length;
    if (deviation(most) > TOLERANCE) console.log(`  ${name}${place}: ${JSON.stringify(most.a)} in the page, ${JSON.stringify(most.b)} on the command line (${deviation(most).toExponential(1)})`);
    if (deviation(most) > worst) [worst, where] = [deviation(most), place];
  }
  return { worst, count, where };
}

/** The largest difference of two estimates, in standard deviations; infinite where runs or verdicts differ. */
function deviations(page, command) {
  if (page.verdict !== command.verdict || page.runs.length !== command.runs.length) return Infinity;
  const ofRun = (run, k) => run.parameters.map((parameter, i) => {
    const other = command.runs[k].parameters[i];
    return parameter.name === other?.name ? Math.abs(parameter.estimate - other.estimate) / other.standard_deviation : Infinity;
  });
  return Math.max(...page.runs.flatMap(ofRun));
}

initSync({ module: readFileSync(join(ROOT, "web/wasm/thetahat_web_bg.wasm")) });
let failed = false;
for (const name of chosen.length > 0 ? chosen : all) {
  const toml = name === "demo" ? "" : readFileSync(join(ROOT, "experiments", `${name}.toml`), "utf8");
  const [page, command] = [inPage(name, toml), onCommandLine(name)];
  const exact = ADAPTIVE[name];
  const pick = ({ runs }) => runs.filter(exact).map(({ simulation_relative_error_percent, ...run }) => run);
  const compared = exact ? [pick(page.results), pick(command.results)] : [page.results, command.results];
  const { worst, count, where } = compare(name, ...compared);
  failed ||= worst > TOLERANCE;
  if (exact) {
    const far = deviations(page.results, command.results);
    failed ||= !(far <= TOLERANCE_IN_DEVIATIONS);
    console.log(`${name}: all estimates within ${far.toExponential(1)} standard deviations`);
  }
  console.log(`${name}: ${count} values, largest deviation ${worst.toExponential(1)} (${where}); page ${page.seconds.toFixed(2)} s, command line ${command.seconds.toFixed(2)} s on one core`);
}
process.exit(failed ? 1 : 0);
