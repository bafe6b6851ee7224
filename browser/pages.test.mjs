// Every page at every width, light and dark: quiet, alone, as wide as its window, and accessible.

import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { after, before, test } from "node:test";
import { axe, noOverflow, uniqueIds } from "./asserts.mjs";
import { HEIGHT, launch, open, openFolds, pagesOf, SCHEMES, WIDTHS } from "./pages.mjs";

/** Widths at which axe runs, which takes a second: contrast depends only on the scheme, scrolling only on the width. */
const AXE_AT = { light: [390, 800], dark: [1400] };
/** Bytes of a page at most. */
const LARGEST = 500e3;
/** What the verdict is called on a page. */
const VERDICTS = { good: /\bgood\b/i, care: /\bcare\b/i, "do-not-use": /\bdo not use\b/i };

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const page of pagesOf(process.env.PAGES)) {
  test(`${page.name}: size`, () => {
    const { size } = statSync(page.file);
    assert.ok(size < LARGEST, `${size} bytes, at most ${LARGEST}`);
  });
  for (const width of WIDTHS) {
    for (const scheme of SCHEMES) {
      test(`${page.name}: ${width} px, ${scheme}`, (t) => at(t, page, width, scheme));
    }
  }
}

async function at(t, { file, results }, width, scheme) {
  const opened = await open(browser, file, { width, scheme });
  if (results) await t.test("the first screen shows the verdict", () => verdictFirst(opened.page, results));
  await openFolds(opened.page);
  await t.test("no overflow", () => noOverflow(opened.page, width));
  await t.test("unique ids", () => uniqueIds(opened.page));
  if (AXE_AT[scheme].includes(width)) await t.test("axe has no findings", () => axe(opened.page));
  await t.test("quiet, and alone", () => {
    assert.deepEqual(opened.complaints, []);
    assert.deepEqual(opened.requests, []);
  });
  await opened.close();
}

/** The verdict, and no better one, is visible without scrolling. */
async function verdictFirst(page, results) {
  const seen = await page.evaluate(textAbove, HEIGHT);
  assert.match(seen, VERDICTS[results.verdict]);
  if (results.verdict === "do-not-use") assert.doesNotMatch(seen, /\bgood\b|\bconverged\b|\b(?:Take|use) idim/i);
}

/** The text whose place is above a height, runs in the page. */
function textAbove(height) {
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  let text = "";
  while (walker.nextNode()) {
    range.selectNodeContents(walker.currentNode);
    const { top, width } = range.getBoundingClientRect();
    if (width > 0 && top < height) text += ` ${walker.currentNode.data}`;
  }
  return text.replace(/\s+/g, " ");
}
