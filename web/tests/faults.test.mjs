// Broken files, cancelled work, reloads and traps: the page says what is wrong, and goes on.

import assert from "node:assert/strict";
import { copyFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { errorOf, folderOf, thetahat } from "./command.mjs";
import { ARM, choose, identify, openSite, status, takeDemo, untilKept, untilReady, visit } from "./site.mjs";

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

/** Files that no reader takes, with what they hold. */
const BROKEN = {
  "ragged.csv": "time,q1,tau1\n0,1,2\n1,2\n2,3,4\n",
  "empty.csv": "",
  "not.mat": "this is no MAT file",
  "not.npz": "PK\x03\x04 broken",
  "not.parquet": "PAR1 broken PAR1",
  "not.db3": "SQLite format 3\0 broken",
  "picture.png": "\x89PNG\r\n",
};

test("broken logs say beside the file what the command line says", async (t) => {
  const folder = folderOf(t, []);
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  for (const [name, content] of Object.entries(BROKEN)) {
    const file = join(folder, name);
    writeFileSync(file, content, "latin1");
    await choose(page, "Choose logs", [file]);
    const item = page.getByRole("list", { name: "Files" }).getByRole("listitem").filter({ hasText: name });
    const said = await item.getByRole("alert").innerText();
    assert.equal(said.trim(), errorOf(thetahat(folder, "inspect", name)), name);
  }
  assertQuiet();
});

test("a broken robot says so, and another one takes its place", async (t) => {
  const folder = folderOf(t, []);
  const { page, close } = await visit(site);
  t.after(close);
  writeFileSync(join(folder, "arm.urdf"), "<robot name='arm'><link name='a'></robot>");
  await choose(page, "Choose robot", [join(folder, "arm.urdf")]);
  const said = await page.getByRole("list", { name: "Files" }).getByRole("alert").innerText();
  assert.equal(said.trim(), errorOf(thetahat(folder, "model", "arm.urdf")));
  copyFileSync(ARM, join(folder, "arm.urdf"));
  await choose(page, "Choose robot", [join(folder, "arm.urdf")]);
  await status(page).filter({ hasText: "Add the log" }).waitFor();
  assert.equal(await page.getByRole("alert").count(), 0);
});

test("work is cancelled, and begun again", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await takeDemo(page);
  await page.getByRole("button", { name: "Identify" }).click();
  await page.getByRole("button", { name: "Cancel" }).click();
  await status(page).filter({ hasText: "Cancelled." }).waitFor();
  assert.equal(await page.locator("iframe").count(), 0);
  assert.match(await identify(page), /^Verdict/);
  assertQuiet();
});

test("a reload in the middle ends the work and keeps the files", async (t) => {
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await takeDemo(page);
  await untilKept(page);
  await page.getByRole("button", { name: "Identify" }).click();
  await page.reload();
  await untilReady(page);
  assert.equal(await page.getByRole("list", { name: "Files" }).getByText("tx40.toml").count(), 1);
  assert.match(await identify(page), /^Verdict/);
  assertQuiet();
});

test("a program that stops is told of, and started again", async (t) => {
  const { page, context, close } = await visit(site, { serviceWorkers: "block" });
  t.after(close);
  // The page reads the worker's script once: the first call to identify says that its worker stops, and no later one.
  await context.route("**/worker.js", async (route) => {
    const answer = await route.fetch();
    const stops = 'addEventListener("message", ({ data }) => { if (data.stops) throw new Error("out of memory"); });\n';
    await route.fulfill({ response: answer, body: stops + (await answer.text()) });
  });
  await context.addInitScript(() => {
    const post = Worker.prototype.postMessage;
    let stopped = false;
    Worker.prototype.postMessage = function (message, transfer) {
      const stops = message.method === "identify" && !stopped;
      stopped ||= stops;
      post.call(this, stops ? { ...message, stops } : message, transfer ?? []);
    };
  });
  await page.reload();
  await takeDemo(page);
  await page.getByRole("button", { name: "Identify" }).click();
  await page.locator("#result").getByRole("alert").filter({ hasText: "The program stopped" }).waitFor();
  assert.match(await identify(page), /^Verdict/);
});

test("files are removed, and everything is forgotten", async (t) => {
  const { page, close } = await visit(site);
  t.after(close);
  await choose(page, "Choose robot", [ARM]);
  await status(page).filter({ hasText: "Add the log" }).waitFor();
  await page.getByRole("button", { name: "Remove arm.urdf" }).click();
  await page.getByRole("list", { name: "Files" }).waitFor({ state: "detached" });
  await takeDemo(page);
  await page.getByRole("button", { name: "Start over" }).click();
  await page.getByRole("list", { name: "Files" }).waitFor({ state: "detached" });
});
