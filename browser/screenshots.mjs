// Screenshots of the pages that `browser/reports` made, at three widths, light and dark: the first screen, and the whole page.
// CHROMIUM=$(browser/chromium) node browser/screenshots.mjs target/browser browser/screenshots

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { launch, open, pagesOf, SCHEMES, WIDTHS } from "./pages.mjs";

const [pages, out] = process.argv.slice(2);
if (!pages || !out) {
  console.error("usage: node browser/screenshots.mjs FOLDER_OF_PAGES FOLDER_FOR_PICTURES");
  process.exit(2);
}
mkdirSync(out, { recursive: true });
const browser = await launch();
for (const { name, file } of pagesOf(pages)) {
  for (const scheme of SCHEMES) {
    for (const width of WIDTHS) {
      const { page, close } = await open(browser, file, { width, scheme });
      const picture = (part, fullPage) => page.screenshot({ path: join(out, `${name}_${width}_${scheme}_${part}.png`), fullPage });
      await picture("first", false);
      if (scheme === "light") await picture("whole", true);
      await close();
    }
  }
}
await browser.close();
