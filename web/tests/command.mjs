// The command line, which the page must agree with.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { differences } from "./numbers.mjs";
import { ARM, REPOSITORY } from "./site.mjs";

const PROGRAM = process.env.THETAHAT ?? join(REPOSITORY, "target/release/thetahat");

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

/** The same with the arm of the tutorial and its log, log.csv. */
export function armFolder(t) {
  const folder = folderOf(t, [ARM, join(REPOSITORY, "examples/arm/twin.toml")]);
  thetahat(folder, "simulate", "twin.toml", "--out", "log.csv");
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

/** Asserts that two results are the same to the tolerances; how many values they have. */
export function assertSame(found, expected) {
  const { count, worst, estimates, areSame } = differences(found, expected);
  assert.ok(areSame, `${worst.place}: ${JSON.stringify(worst.a)}, not ${JSON.stringify(worst.b)}; estimates differ by ${estimates} standard deviations`);
  return count;
}
