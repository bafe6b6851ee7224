// The result of the demo for the first view, computed by the module itself when the page is built, and kept beside the module.

import { createHash } from "node:crypto";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

/** Parameters in the first view. */
const MOST = 28;

/** The result of the module in a folder. */
export async function demoResult(folder) {
  const wasm = readFileSync(join(folder, "thetahat_web_bg.wasm"));
  const version = createHash("sha256").update(wasm).digest("hex");
  const path = join(folder, "demo_result.json");
  const kept = existsSync(path) ? JSON.parse(readFileSync(path, "utf8")) : null;
  if (kept?.version === version) return kept.result;
  const result = summary(await computed(folder, wasm));
  writeFileSync(path, JSON.stringify({ version, result }));
  return result;
}

async function computed(folder, wasm) {
  const { initSync, Session } = await import(pathToFileURL(join(folder, "thetahat_web.js")));
  initSync({ module: wasm });
  const session = new Session(1);
  const { experiment } = JSON.parse(session.sample("demo"));
  return JSON.parse(session.identify(experiment, () => {})).results;
}

/** The recommended run of results, as `views/Preview.tsx` shows it. */
function summary({ verdict, advice, runs }) {
  const method = advice.find((one) => one.case === "nominal").recommended;
  const run = runs.find((one) => one.case === "nominal" && one.method === method);
  const known = run.parameters.filter(({ true_value: value }) => typeof value === "number");
  const value = ({ name, unit, estimate, interval_95: [low, high], true_value }) => ({ name, unit, estimate, half: (high - low) / 2, known: true_value });
  return {
    verdict,
    method,
    error: run.relative_error_percent,
    unseen: run.cross_validation_relative_error_percent,
    values: known.slice(0, MOST).map(value),
  };
}
