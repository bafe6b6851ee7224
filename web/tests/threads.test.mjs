// Several threads where the server's headers allow them, one where not, and where one of several stops.

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { armFolder } from "./command.mjs";
import { textOf } from "./numbers.mjs";
import { ARM, choose, identify, openFolds, openSite, saved, status, takeDemo, untilReady, visit } from "./site.mjs";

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
  const folder = armFolder(t);
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

/** Puts a script before that of the workers with threads, and one before that of the page. */
async function withScripts(t, { worker = "", page: before }) {
  const site = await openSite();
  t.after(site.close);
  const { page, context, close } = await visit(site, { serviceWorkers: "block" });
  t.after(close);
  const cores = await page.evaluate(() => navigator.hardwareConcurrency);
  if (cores < 2) return t.skip("this machine has one processor: no threads are started");
  await context.route("**/threads/worker.js", async (route) => {
    const answer = await route.fetch();
    await route.fulfill({ response: answer, body: worker + (await answer.text()) });
  });
  if (before) await context.addInitScript(before);
  await page.reload();
  return page;
}

const alone = (page) => assert.equal(page.workers().length, 1, "the session's worker goes on alone");

test("a thread that cannot start is done without", async (t) => {
  const refuses = 'addEventListener("message", (event) => { if (event.data.memory) { event.stopImmediatePropagation(); throw new Error("no memory"); } });\n';
  const page = await withScripts(t, { worker: refuses });
  if (!page) return;
  await takeDemo(page);
  assert.match(await identify(page), /^Verdict/);
  alone(page);
});

test("a thread that stops while it works is told of, and the work is begun again without it", async (t) => {
  // The browser ends a thread half a second after the run began: the session then waits for it for ever.
  const page = await withScripts(t, {
    page: () => {
      const post = Worker.prototype.postMessage;
      const threads = [];
      Worker.prototype.postMessage = function (message, transfer) {
        if (message.memory) threads.push(this);
        if (message.method === "identify" && threads.length > 0) {
          const [first] = threads.splice(0);
          setTimeout(() => {
            first.terminate();
            first.dispatchEvent(new ErrorEvent("error", { message: "out of memory" }));
          }, 500);
        }
        post.call(this, message, transfer ?? []);
      };
    },
  });
  if (!page) return;
  await takeDemo(page);
  const verdict = identify(page);
  await status(page).filter({ hasText: "; on one thread, as another one stopped (out of memory)." }).waitFor();
  assert.match(await verdict, /^Verdict/);
  alone(page);
});
