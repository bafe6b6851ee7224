// What a person puts right, by click and by keyboard, changes the experiment as `thetahat init` would.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { armFolder, thetahat } from "./command.mjs";
import { ARM, choose, identify, openFolds, openSite, status, takeDemo, untilReady, visit } from "./site.mjs";

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

/** A page with the arm and its log understood, and a folder with both. */
async function understood(t) {
  const folder = armFolder(t);
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [join(folder, "log.csv")]);
  await untilReady(page);
  await openFolds(page);
  const experiment = page.getByRole("textbox", { name: "experiment.toml" });
  return { page, folder, assertQuiet, experiment };
}

/** Waits until the experiment says something. */
async function untilSays(experiment, pattern) {
  const text = await poll(() => experiment.inputValue(), (value) => pattern.test(value));
  assert.match(text, pattern);
  return text;
}

async function poll(read, isEnough, patience = 20e3) {
  const end = Date.now() + patience;
  let value = await read();
  while (!isEnough(value) && Date.now() < end) {
    await new Promise((wake) => setTimeout(wake, 50));
    value = await read();
  }
  return value;
}

test("units, side and columns are those that were chosen", async (t) => {
  const { page, experiment, assertQuiet } = await understood(t);
  await page.getByLabel("Unit of positions").selectOption("deg");
  await untilSays(experiment, /^position = .*unit = "deg"/m);
  await page.getByLabel("Unit of torques").selectOption("mN m");
  await untilSays(experiment, /^torque = .*unit = "mN m"/m);
  await page.getByLabel("Measured at").selectOption("motor");
  await untilSays(experiment, /^torque = .*side = "motor"/m);
  await page.getByLabel("Torque of waist").selectOption("torque_2");
  await page.getByLabel("Torque of shoulder").selectOption("torque_1");
  await experiment.waitFor();
  await untilSays(experiment, /^torque = .*"torque_2", "torque_1", "torque_3"/m);
  await page.getByRole("button", { name: "Use all as detected" }).click();
  await untilSays(experiment, /^torque = .*"torque_1", "torque_2", "torque_3"\], unit = "N m"/m);
  assertQuiet();
});

test("a joint is locked", async (t) => {
  const { page, experiment } = await understood(t);
  // At once, before it is understood that the joint is locked at 0, and slowly enough that this comes in between.
  await page.getByLabel("Lock elbow").check();
  await page.getByLabel("Value of elbow").selectText();
  await page.keyboard.type("0.5", { delay: 300 });
  await page.keyboard.press("Tab");
  await untilSays(experiment, /^elbow = 0\.5/m);
  await page.getByLabel("Lock waist").check();
  await page.getByLabel("Value of waist").fill("0.25");
  await page.keyboard.press("Tab");
  await untilSays(experiment, /^waist = 0\.25/m);
  await untilSays(experiment, /^elbow = 0\.5/m);
});

test("the window is typed, and dragged on the plot", async (t) => {
  const { page, folder, experiment, assertQuiet } = await understood(t);
  await page.getByLabel("Window from, s").fill("2");
  await page.keyboard.press("Tab");
  await untilSays(experiment, /^window_start_s = 2$/m);
  await page.getByLabel("Window to, s").fill("9");
  await page.keyboard.press("Tab");
  await untilSays(experiment, /^window_end_s = 9$/m);
  await page.getByRole("button", { name: "Choose the filter now" }).click();
  const text = await untilSays(experiment, /Chosen from the data/);
  const init = thetahat(folder, "init", "--robot", "arm.urdf", "--recording", "log.csv", "--window-s", "2", "9");
  assert.equal(init.status, 0, init.stderr);
  assert.equal(text, readFileSync(join(folder, "experiment.toml"), "utf8"));

  const chart = page.locator(".record .chart").first();
  await chart.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await chart.boundingBox();
  await page.mouse.move(x + 0.4 * width, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + 0.6 * width, y + height / 2, { steps: 4 });
  await page.mouse.up();
  await poll(() => experiment.inputValue(), (value) => !/^window_start_s = 2$/m.test(value));
  const [from, to] = await Promise.all(["from", "to"].map((end) => page.getByLabel(`Window ${end}, s`).inputValue().then(Number)));
  assert.ok(from > 4 && to > from && to < 9, `${from} s to ${to} s`);
  assertQuiet();
});

test("an experiment that is changed by hand is the one that runs, and choices do not act on it", async (t) => {
  const { page, experiment } = await understood(t);
  await experiment.fill((await experiment.inputValue()).replace(/^title = .*$/m, 'title = "by hand"'));
  assert.equal(await page.getByLabel("Unit of positions").count(), 0);
  await identify(page);
  await page.frameLocator("iframe").getByRole("heading", { name: "by hand" }).waitFor();
  await page.getByRole("button", { name: "Use the proposal again" }).click();
  await untilSays(experiment, /^title = "arm: log.csv"$/m);
});

test("a gain that no file holds is filled in by hand", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  const folder = armFolder(t);
  const log = readFileSync(join(folder, "log.csv"), "utf8");
  const percent = log.replace(/torque_(\d)/g, "torque_$1 [%]");
  writeFileSync(join(folder, "percent.csv"), percent);
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [join(folder, "percent.csv")]);
  await status(page).filter({ hasText: "Fill in the gain, under Corrections or in experiment.toml." }).waitFor();
  assert.equal(await page.getByRole("button", { name: "Identify" }).count(), 0);
  await page.getByRole("list", { name: "Findings" }).getByText("Fill in gain = [...], a number for each column").waitFor();
  const experiment = page.getByRole("textbox", { name: "experiment.toml" });
  await experiment.fill((await experiment.inputValue()).replace("gain = []", "gain = [100, 100, 100]"));
  assert.match(await identify(page), /^Verdict: (good|use with care)/);
  assertQuiet();
});

test("the drive gain, the controller and the methods are stated in fields", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  const folder = armFolder(t);
  const log = readFileSync(join(folder, "log.csv"), "utf8");
  writeFileSync(join(folder, "percent.csv"), log.replace(/torque_(\d)/g, "torque_$1 [%]"));
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [join(folder, "percent.csv")]);
  await status(page).filter({ hasText: "Fill in the gain, under Corrections" }).waitFor();
  await openFolds(page);
  const experiment = page.getByRole("textbox", { name: "experiment.toml" });
  const gain = page.getByLabel(/^Drive gain/);
  await gain.fill("100, x");
  await page.keyboard.press("Tab");
  await page.getByRole("alert").filter({ hasText: "Numbers separated by commas" }).waitFor();
  await gain.fill("100");
  await page.keyboard.press("Tab");
  await untilSays(experiment, /^torque = .*gain = 100/m);
  await untilReady(page);
  await page.getByLabel(/^Position gain/).fill("4000, 4000, 1000");
  await page.keyboard.press("Tab");
  await page.getByLabel(/^Velocity gain/).fill("100, 100, 20");
  await page.keyboard.press("Tab");
  await untilSays(experiment, /^\[controller\]\nlaw = "pd"\nposition_gain = \[4000, 4000, 1000\]\nvelocity_gain = \[100, 100, 20\]$/m);
  await page.getByLabel("DIDIM").check();
  await untilSays(experiment, /^methods = \["idim-wls", "idim-iv", "didim"\]$/m);
  await page.getByLabel("DIDIM").uncheck();
  await untilSays(experiment, /^methods = \["idim-wls", "idim-iv"\]$/m);
  assert.match(await identify(page), /^Verdict: (good|use with care)/);
  assertQuiet();
});

test("an experiment file is taken as it is, and its errors are the command line's", async (t) => {
  const { page, folder, experiment } = await understood(t);
  const text = (await experiment.inputValue()).replace("cutoff_hz", "cutof_hz");
  writeFileSync(join(folder, "experiment.toml"), text);
  await choose(page, "Choose logs", [join(folder, "experiment.toml")]);
  await untilReady(page);
  assert.equal(await experiment.inputValue(), text);
  await page.getByRole("button", { name: /^Identify/ }).click();
  const said = await page.locator("#result").getByRole("alert").innerText();
  const expected = thetahat(folder, "identify", "experiment.toml").stderr.replace(/^error: /, "");
  assert.equal(said.trim(), expected.trim());
});

test("files are dropped anywhere on the page", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  const transfer = await page.evaluateHandle((text) => {
    const dropped = new DataTransfer();
    dropped.items.add(new File([text], "arm.urdf"));
    return dropped;
  }, readFileSync(ARM, "utf8"));
  await page.dispatchEvent("footer", "drop", { dataTransfer: transfer });
  await page.getByRole("button", { name: "Remove arm.urdf" }).waitFor();
  assertQuiet();
});

test("all of it by keyboard", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await tabTo(page, "Try the demo");
  await page.keyboard.press("Enter");
  await untilReady(page);
  await tabTo(page, "Identify");
  await page.keyboard.press("Enter");
  // A run may take as long as in `identify`.
  await page.frameLocator("iframe").getByRole("region", { name: "Verdict" }).waitFor({ timeout: 120e3 });
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Result", "the reader is led to the result");
  await tabTo(page, "results.json");
  assertQuiet();
});

test("the demo's experiment stays its own until another one is proposed", async (t) => {
  const { page, close } = await visit(site);
  t.after(close);
  await takeDemo(page);
  await openFolds(page);
  assert.equal(await page.getByLabel("Unit of positions").count(), 0);
  await page.getByRole("button", { name: "Propose another one" }).click();
  await page.getByLabel("Unit of positions").waitFor();
});

/** Presses Tab until something with this text has the focus. */
async function tabTo(page, text) {
  for (let presses = 0; presses < 80; presses += 1) {
    await page.keyboard.press("Tab");
    if (await page.evaluate(() => document.activeElement.textContent) === text) return;
  }
  assert.fail(`${text} is not reached by 80 presses of Tab`);
}
