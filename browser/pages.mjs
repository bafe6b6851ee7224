// The pages made by `browser/reports`, and a browser that opens them.

import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

export const WIDTHS = [390, 800, 1400];
export const SCHEMES = ["light", "dark"];
export const HEIGHT = 900;

/** The pages of a folder, each with its name, file and, for a run, its results. */
export function pagesOf(folder) {
  const files = readdirSync(folder).sort();
  const results = (name) => files.includes(`${name}.json`)
    ? JSON.parse(readFileSync(join(folder, `${name}.json`), "utf8"))
    : null;
  return files.filter((file) => file.endsWith(".html")).map((file) => {
    const name = file.slice(0, -".html".length);
    return { name, file: join(folder, file), results: results(name) };
  });
}

/** The browser at CHROMIUM, which `.ci/browser` finds. */
export function launch() {
  const executablePath = process.env.CHROMIUM ?? "chromium";
  // Chromium refuses its sandbox to root, as which containers run; the pages are our own.
  return chromium.launch({ executablePath, args: ["--no-sandbox", "--disable-gpu"] });
}

/** A file in a window, with what it complained of and asked for while it was there. */
export async function open(browser, file, { width = 1400, scheme = "light", script = true } = {}) {
  const context = await browser.newContext({
    viewport: { width, height: HEIGHT },
    colorScheme: scheme,
    javaScriptEnabled: script,
  });
  const page = await context.newPage();
  const url = pathToFileURL(file).href;
  const complaints = [];
  const requests = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => {
    if (request.url() !== url && !request.url().startsWith("data:")) requests.push(request.url());
  });
  await page.goto(url, { waitUntil: "load" });
  return { page, complaints, requests, close: () => context.close() };
}

/** Opens every fold of a page. */
export function openFolds(page) {
  return page.evaluate(() => document.querySelectorAll("details").forEach((fold) => { fold.open = true; }));
}
