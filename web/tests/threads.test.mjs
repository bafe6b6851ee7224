// Several threads where the server's headers allow them, one where not.

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { folderOf, thetahat } from "./command.mjs";
import { textOf } from "./numbers.mjs";
import { ARM, choose, identify, openFolds, openSite, REPOSITORY, saved, takeDemo, untilReady, visit } from "./site.mjs";

/** What a page that is served with some headers, or those of `web/serve`, makes of files. */
async function answered(t, work, headers) {
  const site = await openSite({ headers });
  t.after(site.close);
  const { page, assertQuiet, close } = await visit(site);
  t.after(close);
  await work(page);
  await identify(page);
  await openFolds(page);
  const experiment = await page.getByRole("textbox", { name: "experiment.toml" }).inputValue();
  const answer = { experiment, results: textOf(JSON.parse(await saved(page, "results.json"))) };
  const cores = await page.evaluate(() => (crossOriginIsolated ? navigator.hardwareConcurrency : 1));
  assert.equal(page.workers().length, cores === 1 ? 1 : 1 + Math.min(cores, 16), "a worker for the session, and one for each thread");
  assertQuiet();
  return { ...answer, cores };
}

/** The log of the tutorial's arm, for which the filter is chosen too. */
function armOf(t) {
  const folder = folderOf(t, [ARM, join(REPOSITORY, "examples/arm/twin.toml")]);
  thetahat(folder, "simulate", "twin.toml", "--out", "log.csv");
  return async (page) => {
    await choose(page, "Choose robot", [ARM]);
    await choose(page, "Choose logs", [join(folder, "log.csv")]);
    await untilReady(page);
  };
}

for (const [name, work] of [["the demo", () => takeDemo], ["the arm", armOf]]) {
  test(`${name}: numbers do not depend on the threads`, async (t) => {
    const todo = work(t);
    const [several, one] = [await answered(t, todo), await answered(t, todo, { "Cache-Control": "no-cache" })];
    if (several.cores < 2) t.diagnostic("this machine has one processor: no threads were started");
    assert.equal(one.cores, 1);
    assert.equal(several.experiment, one.experiment);
    assert.equal(several.results, one.results);
  });
}
