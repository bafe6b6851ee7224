// What the pages' script does where a page has one, and that all is readable without it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, open, openFolds, pagesOf } from "./pages.mjs";
import { structureOf } from "./structure.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const { name, file } of pagesOf(process.env.PAGES)) {
  test(`${name}: readable without script`, async () => {
    const [plain, scripted] = await Promise.all([false, true].map((script) => open(browser, file, { script })));
    await openFolds(plain.page);
    const [without, all] = await Promise.all([plain, scripted].map(({ page }) => structureOf(page)));
    const hidden = await plain.page.evaluate(hiddenParts);
    const idle = await plain.page.locator("button:visible").count();
    await Promise.all([plain.close(), scripted.close()]);
    assert.deepEqual(without, all);
    assert.deepEqual(hidden, []);
    assert.equal(idle, 0, "buttons that nothing listens to");
  });
}

/** Tables and drawings that do not show, runs in the page. */
function hiddenParts() {
  const parts = [...document.querySelectorAll("table, svg[role=img]")];
  return parts.filter((part) => !part.checkVisibility() || part.getBoundingClientRect().height === 0)
    .map((part) => part.outerHTML.slice(0, 120));
}
