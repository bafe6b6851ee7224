// A reload keeps files, choices and results; unsaved results are asked for; long recordings are read; steps are counted.

import assert from "node:assert/strict";
import { createWriteStream, readFileSync } from "node:fs";
import { join } from "node:path";
import { finished } from "node:stream/promises";
import { after, before, test } from "node:test";
import { armFolder } from "./command.mjs";
import { ARM, choose, identify, openFolds, openSite, saved, status, takeDemo, untilKept, untilReady, visit } from "./site.mjs";

/** Bytes of a long recording. */
const LONG = 25e6;

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

test("a reload keeps files, choices and the result, and Start over forgets them", async (t) => {
  const folder = armFolder(t);
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [join(folder, "log.csv")]);
  await untilReady(page);
  await openFolds(page);
  await page.getByLabel("Window to, s").fill("9");
  await page.keyboard.press("Tab");
  await untilReady(page);
  const verdict = await identify(page);
  await untilKept(page);
  page.on("dialog", (dialog) => dialog.accept());
  await page.reload();
  await status(page).filter({ hasText: verdict }).waitFor();
  await page.frameLocator("iframe").getByRole("region", { name: "Verdict" }).waitFor();
  await openFolds(page);
  assert.equal(await page.getByLabel("Window to, s").inputValue(), "9");
  assert.equal(await identify(page), verdict, "the files are there again");
  await page.getByRole("button", { name: "Start over" }).click();
  await untilKept(page);
  await page.reload();
  await page.getByRole("button", { name: "Try the arm" }).waitFor();
  assert.equal(await page.getByRole("list", { name: "Files" }).count(), 0);
  assertQuiet();
});

test("another tab begins empty", async (t) => {
  const { page, context, close } = await visit(site);
  t.after(close);
  await takeDemo(page);
  await untilKept(page);
  const other = await context.newPage();
  await other.goto(site.url);
  await other.getByRole("button", { name: "Try the arm" }).waitFor();
  assert.equal(await other.getByRole("list", { name: "Files" }).count(), 0);
});

test("leaving asks while a result is not saved, and not after", async (t) => {
  const folder = armFolder(t);
  const { page, close } = await visit(site);
  t.after(close);
  const asked = [];
  page.on("dialog", (dialog) => { asked.push(dialog.type()); return dialog.accept(); });
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [join(folder, "log.csv")]);
  await untilReady(page);
  await identify(page);
  await untilKept(page);
  await page.reload();
  assert.deepEqual(asked, ["beforeunload"]);
  await page.frameLocator("iframe").getByRole("region", { name: "Verdict" }).waitFor();
  await saved(page, "results.json");
  await untilKept(page);
  await page.reload();
  await page.frameLocator("iframe").getByRole("region", { name: "Verdict" }).waitFor();
  assert.deepEqual(asked, ["beforeunload"]);
});

test("a recording of 25 MB is read", async (t) => {
  const folder = armFolder(t);
  const [head, ...rows] = readFileSync(join(folder, "log.csv"), "utf8").trimEnd().split("\n");
  const file = join(folder, "long.csv");
  const out = createWriteStream(file);
  out.write(`${head}\n`);
  let [bytes, sample] = [0, 0];
  while (bytes < LONG) {
    // The motion again and again: it begins and ends at rest in the same place.
    const row = `${(sample / 1000).toFixed(3)}${rows[sample % rows.length].replace(/^[^,]*/, "")}\n`;
    out.write(row);
    [bytes, sample] = [bytes + row.length, sample + 1];
  }
  out.end();
  await finished(out);
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await choose(page, "Choose robot", [ARM]);
  await choose(page, "Choose logs", [file]);
  await status(page).filter({ hasText: "Ready to identify." }).waitFor({ timeout: 120_000 });
  assert.ok((await page.getByText(`${sample} samples`).count()) > 0);
  assert.equal(await page.getByRole("alert").count(), 0);
  assertQuiet();
});

test("the bar knows its end where the program counts its steps", async (t) => {
  const { page, close } = await visit(site);
  t.after(close);
  await takeDemo(page);
  await page.evaluate(() => {
    globalThis.ends = [];
    new MutationObserver(() => {
      const bar = document.querySelector(".bar progress");
      if (bar?.hasAttribute("value")) globalThis.ends.push([bar.value, bar.max]);
    }).observe(document.querySelector(".bar"), { subtree: true, childList: true, attributes: true });
  });
  await identify(page);
  const ends = await page.evaluate(() => globalThis.ends);
  assert.ok(ends.length > 0 && ends.every(([done, of]) => of === 6 && done <= of), JSON.stringify(ends.slice(0, 5)));
});
