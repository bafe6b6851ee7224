// What a page consists of, and in what order: compared with `structure.json`, which `.ci/browser --update` writes anew.

import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { launch, open, pagesOf } from "./pages.mjs";
import { structureOf } from "./structure.mjs";

const FILE = new URL("structure.json", import.meta.url);
const update = Boolean(process.env.UPDATE);
const known = existsSync(FILE) ? JSON.parse(readFileSync(FILE, "utf8")) : {};

let browser;
before(async () => { browser = await launch(); });
after(async () => {
  await browser.close();
  if (update) writeFileSync(FILE, `${JSON.stringify(known, null, 2)}\n`);
});

for (const { name, file, results } of pagesOf(process.env.PAGES)) {
  test(`${name}: structure`, async () => {
    const { page, close } = await open(browser, file);
    const structure = await structureOf(page);
    await close();
    if (update) known[name] = structure;
    assert.deepEqual(structure, known[name]);
  });
  if (results) {
    test(`${name}: verdict, torques, estimates, and then the rest`, async () => {
      const { page, close } = await open(browser, file);
      const places = await page.evaluate(placesOf, results.runs[0].parameters[0].name);
      await close();
      assert.ok(places.verdict < places.torques, `verdict at ${places.verdict} px, torques at ${places.torques} px`);
      assert.ok(places.torques < places.estimates, `torques at ${places.torques} px, estimates at ${places.estimates} px`);
    });
  }
}

/** Where the parts of a page begin, runs in the page: the verdict, the first figure of torques, the first parameter. */
function placesOf(parameter) {
  const top = (element) => (element ? element.getBoundingClientRect().top + scrollY : Infinity);
  const first = (selector, matches) => top([...document.querySelectorAll(selector)].find(matches));
  const ownText = (element) => [...element.childNodes].filter((n) => n.nodeType === Node.TEXT_NODE).map((n) => n.data).join(" ");
  return {
    verdict: first("body *", (e) => /\b(good|care|do not use)\b/i.test(ownText(e))),
    torques: first("figure", (e) => /torque/i.test((e.querySelector("figcaption") ?? e).textContent)),
    estimates: first("td, tbody th, svg text", (e) => e.textContent.trim() === parameter),
  };
}
