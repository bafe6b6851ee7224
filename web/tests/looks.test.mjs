// Every state at every width, light and dark: as wide as its window, accessible and quiet.

import { after, before, test } from "node:test";
import { axe, noOverflow, uniqueIds } from "../../browser/asserts.mjs";
import { SCHEMES, WIDTHS } from "../../browser/pages.mjs";
import { folderOf } from "./command.mjs";
import { openFolds, openSite, visit } from "./site.mjs";
import { STATES } from "./states.mjs";

/** Where axe looks, which takes a second: contrast depends on the scheme alone, what scrolls on the width alone. */
const AXE_AT = { light: [390, 1400], dark: [800] };

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

for (const width of WIDTHS) {
  for (const scheme of SCHEMES) {
    test(`${width} px, ${scheme}`, async (t) => {
      const { page, assertQuiet, close } = await visit(site, { width, scheme });
      t.after(close);
      const folder = folderOf(t, []);
      for (const [state, reach] of Object.entries(STATES)) {
        await t.test(state, async () => {
          await reach(page, folder);
          await openFolds(page);
          await noOverflow(page, width);
          await uniqueIds(page);
          if (AXE_AT[scheme].includes(width)) await axe(page);
        });
      }
      assertQuiet();
    });
  }
}
