// The command line, which the page must agree with.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { compare, deviationOfEstimates } from "./numbers.mjs";
import { REPOSITORY } from "./site.mjs";

const PROGRAM = process.env.THETAHAT ?? join(REPOSITORY, "target/release/thetahat");

/** Relative difference of two numbers at most. */
const TOLERANCE = 1e-9;

/** Difference of two estimates at most, in standard deviations: twice the change at which iterations end. */
const SIMULATED = 0.1;

/** Runs the program in a folder; exit code 1 is a verdict. */
export function thetahat(folder, ...args) {
  const { status, stdout, stderr, error } = spawnSync(PROGRAM, args, { cwd: folder, encoding: "utf8" });
  if (error) throw error;
  return { status, stdout, stderr };
}

/** A new folder with copies of files, for as long as a test takes. */
export function folderOf(t, files) {
  const folder = mkdtempSync(join(tmpdir(), "thetahat-web-"));
  t.after(() => rmSync(folder, { recursive: true }));
  for (const file of files) copyFileSync(file, join(folder, basename(file)));
  return folder;
}

/** The text of the experiment that `init` writes for a robot and its recordings. */
export function proposed(folder, robot, recordings) {
  const named = recordings.flatMap((recording) => ["--recording", basename(recording)]);
  const { status, stderr } = thetahat(folder, "init", "--robot", basename(robot), ...named);
  assert.equal(status, 0, stderr);
  return readFileSync(join(folder, "experiment.toml"), "utf8");
}

/** What `identify` makes of the text of an experiment. */
export function identified(folder, experiment) {
  writeFileSync(join(folder, "experiment.toml"), experiment);
  const { status, stderr } = thetahat(folder, "identify", "experiment.toml", "--out", "results", "--quiet");
  assert.ok(status <= 1, stderr);
  return JSON.parse(readFileSync(join(folder, "results/results.json"), "utf8"));
}

/** What the program says of a failure, without the word before it. */
export function errorOf({ status, stderr }) {
  assert.equal(status, 2, "the program fails");
  return stderr.replace(/^error: /, "").trim();
}

/**
 * Asserts that two results are the same to the tolerance; how many values they have. Estimates by IV may differ as simulations do, whose
 * steps the integrator chooses: the sines of the browser have other last digits.
 */
export function assertSame(found, expected) {
  const simulated = deviationOfEstimates(found, expected);
  assert.ok(simulated <= SIMULATED, `estimates differ by ${simulated} standard deviations`);
  const { count, worst } = compare(ofMeasurement(found), ofMeasurement(expected));
  assert.ok(worst.deviation <= TOLERANCE, `${worst.place}: ${JSON.stringify(worst.a)}, not ${JSON.stringify(worst.b)}`);
  return count;
}

/** Results without the figures of simulations. */
function ofMeasurement({ runs, advice, verdict_reasons: reasons, diagnostics: _, ...others }) {
  const measured = runs.filter(({ method }) => method === "idim-ls" || method === "idim-wls").map(withoutSimulation);
  assert.ok(measured.length > 0, "a run without simulations is compared");
  return { ...others, runs: measured, taken: advice.map(({ take }) => take), reasons: reasons.map(({ code }) => code) };
}

function withoutSimulation({ simulation_relative_error_percent: _, validation_simulation_relative_error_percent: __, ...run }) {
  return run;
}
