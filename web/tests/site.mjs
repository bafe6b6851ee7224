// The built page on localhost, a browser that opens it, and the steps that a person takes.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { HEIGHT, launch } from "../../browser/pages.mjs";
import { serve } from "../serve.mjs";

const HERE = dirname(fileURLToPath(import.meta.url));
export const REPOSITORY = resolve(HERE, "../..");
export const SINGLE_FILE = resolve(HERE, "../dist/thetahat.html");
/** The robot of the tutorial. */
export const ARM = join(REPOSITORY, "examples/arm/arm.urdf");

/** Milliseconds that a step may take, and the longest run. */
const PATIENCE = { step: 20e3, run: 120e3 };

/** What Chromium says of drawing without a graphics processor when a picture of the window is taken. */
const IS_OF_PICTURES = /GL Driver Message \(OpenGL, Performance.*GPU stall due to ReadPixels/;

/** A folder of the recorded data, beside the checkout or at THETAHAT_SHARED; none where they are not there. */
export function dataset(name) {
  const shared = process.env.THETAHAT_SHARED ?? resolve(REPOSITORY, "../shared");
  const folder = join(shared, "datasets", name);
  return existsSync(folder) ? folder : null;
}

/** The server and the browser of a file of tests. */
export async function openSite(options = {}) {
  const [server, browser] = await Promise.all([serve(0, options), launch()]);
  const url = `http://localhost:${server.address().port}/`;
  const close = async () => {
    await browser.close();
    server.closeAllConnections();
    await new Promise((done) => server.close(done));
  };
  return { url, browser, server, close };
}

/** A window on an address, with what it complained of and what it asked of others while it was there. */
export async function visit({ browser, url }, { width = 1400, scheme = "light", address = url, serviceWorkers = "allow", prepare = null } = {}) {
  const context = await browser.newContext({ viewport: { width, height: HEIGHT }, colorScheme: scheme, reducedMotion: "reduce", serviceWorkers });
  if (prepare) await context.addInitScript(prepare);
  const complaints = [];
  const strangers = [];
  const origin = new URL(address).origin;
  context.on("request", (request) => {
    const asked = request.url();
    const isOwn = asked === address || asked.startsWith(`${origin}/`) || /^(blob|data):/.test(asked);
    if (!isOwn) strangers.push(asked);
  });
  context.on("console", (message) => {
    if (["error", "warning"].includes(message.type()) && !IS_OF_PICTURES.test(message.text())) complaints.push(message.text());
  });
  context.on("weberror", (error) => complaints.push(String(error.error())));
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE.step);
  await page.goto(address);
  await page.getByRole("button", { name: "Try the demo" }).waitFor();
  const assertQuiet = () => {
    assert.deepEqual(complaints, []);
    assert.deepEqual(strangers, []);
  };
  return { page, context, complaints, strangers, assertQuiet, close: () => context.close() };
}

/** Chooses files, as the button opens the chooser. */
export async function choose(page, button, files) {
  const chooser = page.waitForEvent("filechooser");
  await page.getByRole("button", { name: button, exact: true }).click();
  await (await chooser).setFiles(files);
}

/** The line of the bar at the lower edge. */
export function status(page) {
  return page.getByRole("status");
}

export async function untilReady(page) {
  await status(page).filter({ hasText: "Ready to identify." }).waitFor();
}

/** Loads the demo and waits until it is understood. */
export async function takeDemo(page) {
  await page.getByRole("button", { name: "Try the demo" }).click();
  await untilReady(page);
}

/** Opens the drawing in 3D and waits until it is there. */
export async function openSpace(page) {
  await page.getByRole("button", { name: "Show in 3D" }).click();
  await page.locator("figure.space[aria-busy=false]").waitFor();
}

/** Identifies, and gives the line with the verdict. */
export async function identify(page) {
  await page.getByRole("button", { name: /^Identify/ }).click();
  const verdict = status(page).filter({ hasText: /^Verdict: / });
  await verdict.waitFor({ timeout: PATIENCE.run });
  return verdict.innerText();
}

/** The text of a file that the page gives. */
export async function saved(page, name) {
  const download = page.waitForEvent("download");
  await page.getByRole("button", { name, exact: true }).click();
  const stream = await (await download).createReadStream();
  const parts = [];
  for await (const part of stream) parts.push(part);
  return Buffer.concat(parts).toString("utf8");
}

/** Waits until what a reload finds again is that the page rests as it does: the pause of `kept.ts`, and the time to write. */
export function untilKept(page) {
  return page.waitForTimeout(1000);
}

/** Opens every fold of the page. */
export function openFolds(page) {
  return page.evaluate(() => document.querySelectorAll("details").forEach((fold) => { fold.open = true; }));
}
