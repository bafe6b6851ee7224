// A printed page shows the content of its folds.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, open, openFolds, pagesOf } from "./pages.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const { name, file } of pagesOf(process.env.PAGES)) {
  for (const script of [true, false]) {
    test(`${name}: folds are open in print, ${script ? "with" : "without"} script`, async () => {
      const { page, close } = await open(browser, file, { script });
      const printed = await sheets(page);
      await page.emulateMedia({ media: "print" });
      const hidden = await page.evaluate(hiddenInFolds);
      await page.emulateMedia({ media: null });
      await openFolds(page);
      const opened = await sheets(page);
      await close();
      assert.deepEqual(hidden, []);
      assert.equal(printed, opened, "sheets as the page opens, and with all folds opened by hand");
    });
  }
}

/** Sheets of the PDF. */
async function sheets(page) {
  const pdf = (await page.pdf({ format: "A4" })).toString("latin1");
  return pdf.match(/\/Type\s*\/Page\b/g).length;
}

/** The titles of folds whose content does not show, runs in the page. */
function hiddenInFolds() {
  const hidden = (fold) => [...fold.children].some((child) => child.localName !== "summary" && !child.checkVisibility());
  return [...document.querySelectorAll("details")].filter(hidden).map((fold) => fold.querySelector("summary").textContent);
}
