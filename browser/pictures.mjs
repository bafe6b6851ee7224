// The pictures of the documentation, from the runs that `browser/pictures` made: node browser/pictures.mjs RUNS DOCS

import { execFileSync } from "node:child_process";
import { statSync } from "node:fs";
import { join } from "node:path";
import { launch, open } from "./pages.mjs";

/** Bytes of a picture at most. */
const LARGEST = 100e3;
/** Width of the window, px. */
const WIDTH = 1000;

const [runs, docs] = process.argv.slice(2);
const browser = await launch();

await firstScreen("demo", "report.png", 640);
await firstScreen("tutorial/results", "tutorial/good.png", 560);
await firstScreen("tutorial/swapped", "tutorial/do_not_use.png", 560);
await torques("tutorial/results", "tutorial/torques.png");
await figure("design/arm", "design/motion.png", "#motion figure:has(.panel .zero)");
await figure("design/arm", "design/predicted.png", "#prediction .forest");
await figure("design/cell", "design/distance.png", "#distances figure");
await browser.close();

/** The part of a report that is visible without scrolling. */
function firstScreen(run, picture, height) {
  return keep(run, picture, (page, path) => page.screenshot({ path, clip: { x: 0, y: 0, width: WIDTH, height } }));
}

/** The first figure of torques. */
function torques(run, picture) {
  const figure = (page) => page.locator("figure", { hasText: /torque/i }).first();
  return keep(run, picture, (page, path) => figure(page).screenshot({ path }));
}

/** A figure of the page of a design. */
function figure(run, picture, selector) {
  return keep(run, picture, (page, path) => page.locator(selector).first().screenshot({ path }), "design.html");
}

async function keep(run, picture, take, file = "report.html") {
  const { page, close } = await open(browser, join(runs, run, file), { width: WIDTH });
  const path = join(docs, picture);
  await take(page, path);
  await close();
  execFileSync("pngquant", ["--force", "--output", path, "64", path]);
  const { size } = statSync(path);
  console.log(`${path}: ${size} bytes`);
  if (size > LARGEST) throw new Error(`${path} has more than ${LARGEST} bytes`);
}
