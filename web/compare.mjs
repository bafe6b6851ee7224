// Compares what the module gives in Node with what the command line gives, number by number, and the times of both with one core.
//
//   node web/compare.mjs PROGRAM [DATASETS [EXPERIMENT...]]
//
// Without DATASETS only the demonstration is compared. Exits with 1 where results differ by more than `tests/numbers.mjs` allows.

import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { differences } from "./tests/numbers.mjs";
import { initSync, Session } from "./wasm/thetahat_web.js";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "..");
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
  const session = new Session(1);
  if (name !== "demo") put(session, name, toml);
  const text = name === "demo" ? JSON.parse(session.sample("demo")).experiment : toml;
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

initSync({ module: readFileSync(join(ROOT, "web/wasm/thetahat_web_bg.wasm")) });
let failed = false;
for (const name of chosen.length > 0 ? chosen : all) {
  const toml = name === "demo" ? "" : readFileSync(join(ROOT, "experiments", `${name}.toml`), "utf8");
  const [page, command] = [inPage(name, toml), onCommandLine(name)];
  const { count, worst, estimates, areNear, areSame } = differences(page.results, command.results);
  failed ||= !(name === "demo" ? areNear : areSame);
  const where = worst.place ? ` (${worst.place}: ${worst.a} and ${worst.b})` : "";
  const numbers = name === "demo" ? "" : `${count} values, largest deviation ${worst.deviation.toExponential(1)}${where}; `;
  console.log(`${name}: ${numbers}estimates within ${estimates.toExponential(1)} standard deviations; page ${page.seconds.toFixed(2)} s, command line ${command.seconds.toFixed(2)} s on one core`);
}
process.exit(failed ? 1 : 0);
