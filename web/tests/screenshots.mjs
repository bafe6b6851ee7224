// Screenshots of every state, at three widths, light and dark: CHROMIUM=$(browser/chromium) node web/tests/screenshots.mjs FOLDER

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { SCHEMES, WIDTHS } from "../../browser/pages.mjs";
import { openSite, visit } from "./site.mjs";
import { STATES } from "./states.mjs";

const [out] = process.argv.slice(2);
if (!out) {
  console.error("usage: node web/tests/screenshots.mjs FOLDER_FOR_PICTURES");
  process.exit(2);
}
mkdirSync(out, { recursive: true });
const site = await openSite();
for (const scheme of SCHEMES) {
  for (const width of WIDTHS) {
    const { page, close } = await visit(site, { width, scheme });
    for (const [state, reach] of Object.entries(STATES)) {
      await reach(page, out);
      const picture = (part, fullPage) => page.screenshot({ path: join(out, `${state}_${width}_${scheme}_${part}.png`), fullPage });
      await picture("first", false);
      if (scheme === "light") await picture("whole", true);
    }
    await close();
  }
}
await site.close();
