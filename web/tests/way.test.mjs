// The whole way of a person, and its figures against the command line's.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { armFolder, assertSame, folderOf, identified, proposed, thetahat } from "./command.mjs";
import { differences } from "./numbers.mjs";
import { ARM, choose, dataset, identify, openFolds, openSite, REPOSITORY, saved, takeDemo, untilReady, visit } from "./site.mjs";

const NUMBER = /-?\d+(?:\.\d+)?(?:e-?\d+)?/g;

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

/** Recorded robots: the description, and the files of the log. */
const RECORDED = [
  { name: "kuka_lwr4", robot: (folder) => join(folder, "kuka_lwr4.urdf"), logs: ["measurements_2.npz"] },
  { name: "ur10", robot: () => join(REPOSITORY, "robots/ur10.toml"), logs: ["ur10_exciting_trajectory.db3"] },
  { name: "emps", robot: () => join(REPOSITORY, "robots/emps.toml"), logs: ["DATA_EMPS.mat"] },
];

test("the demo: the verdict, the report and the files", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await takeDemo(page);
  await assertUnderstood(page, 6);
  assert.match(await identify(page), /^Verdict: (good|use with care)\. Recommended method: idim-/);
  await assertReport(page);
  const results = JSON.parse(await saved(page, "results.json"));
  const expected = JSON.parse(thetahat(REPOSITORY, "demo", "--json").stdout);
  const { estimates, areNear } = differences(results, expected);
  assert.ok(areNear, `${estimates} standard deviations`);
  assert.match(await saved(page, "report.html"), /^<!DOCTYPE html>/);
  assert.match(await saved(page, "parameters.csv"), /idim-ls/);
  assertQuiet();
});

test("a robot and its log: the figures and the files of the command line", async (t) => {
  const folder = armFolder(t);
  const page = await compare(t, ARM, [join(folder, "log.csv")], 3);
  await page.getByRole("button", { name: "MJCF", exact: true }).click();
  const mjcf = await saved(page, "arm.xml");
  identified(folder, await page.getByRole("textbox", { name: "experiment.toml" }).inputValue());
  const expected = thetahat(folder, "export", "results/results.json", "--to", "mjcf").stdout;
  assert.deepEqual(mjcf.split(NUMBER).length, expected.split(NUMBER).length);
  const [found, numbers] = [mjcf, expected].map((text) => text.match(NUMBER).map(Number));
  // The estimates are those of IV: they differ as simulations do.
  const isNear = (a, b) => Math.abs(a - b) <= 0.02 * Math.max(0.05, Math.abs(b));
  numbers.forEach((number, index) => assert.ok(isNear(found[index], number), `${found[index]}, not ${number}`));
});

for (const { name, robot, logs } of RECORDED) {
  test(`${name}: the figures and the file of the command line`, async (t) => {
    const folder = dataset(name);
    if (!folder) return t.skip("the recorded data are not beside the checkout, nor at THETAHAT_SHARED");
    return compare(t, robot(folder), logs.map((log) => join(folder, log)));
  });
}

test("a remedy: one button mends the experiment and identifies again", async (t) => {
  const folder = armFolder(t);
  const log = join(folder, "log.csv");
  // The names of the first two torques exchanged.
  const text = readFileSync(log, "utf8");
  writeFileSync(log, text.replace("torque_1", "other").replace("torque_2", "torque_1").replace("other", "torque_2"));
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [log]);
  await untilReady(page);
  assert.match(await identify(page), /^Verdict: do not use/);
  const remedies = page.getByRole("list", { name: "Remedies" });
  await remedies.getByRole("button", { name: /^Exchange the torques of joints 1 and 2/ }).click();
  const change = page.getByRole("region", { name: /^Change by: Exchange/ });
  await change.waitFor({ timeout: 120_000 });
  assert.match(await change.innerText(), /verdict +(good|care), before do-not-use/);
  await openFolds(page);
  assert.match(await page.getByRole("textbox", { name: "experiment.toml" }).inputValue(), /"torque_2", "torque_1"/);
  assertQuiet();
});

/** Goes the whole way with files, and compares what it yields with the command line's. */
async function compare(t, robot, logs, joints) {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await choose(page, "Choose robot", [robot]);
  await choose(page, "Choose logs", logs);
  await untilReady(page);
  await assertUnderstood(page, joints);
  await identify(page);
  await assertReport(page);
  await openFolds(page);
  const experiment = await page.getByRole("textbox", { name: "experiment.toml" }).inputValue();
  const folder = folderOf(t, [robot, ...logs]);
  assert.equal(withoutNeighbours(experiment), withoutNeighbours(proposed(folder, robot, logs)));
  const values = assertSame(JSON.parse(await saved(page, "results.json")), identified(folder, experiment));
  assert.ok(values > 100, `${values} values are compared`);
  assertQuiet();
  return page;
}

/**
 * An experiment without the lines of the errors that other filters would have: they are of twins, simulated with steps that the integrator
 * chooses; of EMPS their third digit differs.
 */
function withoutNeighbours(experiment) {
  return experiment.replace(/^# {3}every .*\n/gm, "");
}

/** The robot moves, and each joint has its curves. */
async function assertUnderstood(page, joints) {
  await page.getByRole("img", { name: "The robot as a stick figure" }).waitFor();
  const curves = await page.locator(".record .chart").count();
  assert.ok(joints ? curves === joints : curves > 0, `${curves} charts`);
  const figure = () => page.locator(".stick .link").getAttribute("d");
  const before = await figure();
  const time = page.getByRole("slider", { name: "Time" });
  // Not halfway, where a motion may be back at its start.
  await time.fill(String(Math.round(Number(await time.getAttribute("max")) * 0.37)));
  assert.notEqual(await figure(), before, "the robot moves");
}

/** The report is in its frame, as high as it is, and its script runs. */
async function assertReport(page) {
  const report = page.frameLocator("iframe");
  await report.getByRole("region", { name: "Verdict" }).waitFor();
  await report.getByRole("button", { name: "Zoom in" }).first().click();
  const [outside, inside] = await page.evaluate(() => {
    const frame = document.querySelector("iframe");
    return [frame.clientHeight, frame.contentDocument.documentElement.offsetHeight];
  });
  assert.ok(Math.abs(outside - inside) < 2, `${outside} px for ${inside} px`);
}
