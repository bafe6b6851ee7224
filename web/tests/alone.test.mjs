// Without a network, as one file from a folder, and quick.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer, get } from "node:http";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { brotliDecompressSync, gunzipSync } from "node:zlib";
import { identify, openSite, openSpace, REPOSITORY, SINGLE_FILE, takeDemo, visit } from "./site.mjs";

/** Bytes of the wasm at most, as it is sent to browsers: 3.44e6 by the compiler 1.96; the drawing in 3D has 15e3 of it unpacked. */
const LARGEST_WASM = 3.6e6;
/** Bytes of the drawing in 3D at most, likewise: three and its readers of meshes. */
const LARGEST_SPACE = 1.8e5;
/** Milliseconds until the first view at most. */
const FIRST_VIEW = 1000;

let site;
before(async () => { site = await openSite(); });
after(() => site.close());

test("a page that was opened once works without a network", async (t) => {
  const { page, context, assertQuiet, close } = await visit(site);
  t.after(close);
  await page.evaluate(() => navigator.serviceWorker.ready);
  await context.setOffline(true);
  await page.reload();
  await takeDemo(page);
  await openSpace(page);
  assert.match(await identify(page), /^Verdict/);
  assertQuiet();
});

test("the single file works from a folder", async (t) => {
  const { page, assertQuiet, close } = await visit(site, { address: pathToFileURL(SINGLE_FILE).href });
  t.after(close);
  await takeDemo(page);
  assert.match(await identify(page), /^Verdict/);
  await page.frameLocator("iframe").getByRole("region", { name: "Verdict" }).waitFor();
  await openSpace(page);
  assertQuiet();
});

test("no request to another address is possible", async (t) => {
  const asked = [];
  const stranger = createServer((request, response) => { asked.push(request.url); response.end(); });
  await new Promise((listening) => stranger.listen(0, "127.0.0.1", listening));
  t.after(() => stranger.close());
  const { page, complaints, close } = await visit(site);
  t.after(close);
  await page.evaluate(async (address) => {
    await fetch(`${address}fetched`).catch(() => {});
    const picture = new Image();
    const refused = new Promise((done) => { picture.onload = picture.onerror = done; });
    picture.src = `${address}picture`;
    navigator.sendBeacon(`${address}beacon`, "data");
    await refused;
  }, `http://localhost:${stranger.address().port}/`);
  assert.deepEqual(asked, []);
  for (const name of ["fetched", "picture", "beacon"]) {
    assert.ok(complaints.some((text) => text.includes(`/${name}' violates the following Content Security Policy`)), name);
  }
});

/** What the server sends to a client that accepts a coding, as it stands in the answer. */
async function sent(name, coding) {
  const answer = await new Promise((done, failed) => get(site.url + name, { headers: { "Accept-Encoding": coding } }, done).on("error", failed));
  const parts = [];
  for await (const part of answer) parts.push(part);
  return { headers: answer.headers, body: Buffer.concat(parts) };
}

test("files are sent packed to those who accept it", async (t) => {
  for (const name of ["thetahat_web_bg.wasm", "threads/thetahat_web_bg.wasm", "page.js", "robot3d.js"]) {
    const file = readFileSync(join(REPOSITORY, "web/dist", name));
    const unpack = { "gzip, deflate, br, zstd": brotliDecompressSync, "gzip, br;q=0": gunzipSync, identity: (bytes) => bytes };
    for (const [accepted, unpacked] of Object.entries(unpack)) {
      const { headers, body } = await sent(name, accepted);
      assert.ok(unpacked(body).equals(file), `${name} for ${accepted}`);
      assert.equal(headers.vary, "Accept-Encoding");
      assert.equal(headers["content-type"], name.endsWith("wasm") ? "application/wasm" : "text/javascript; charset=utf-8");
      if (name.endsWith("wasm")) t.diagnostic(`${name}: ${body.length} bytes by ${headers["content-encoding"] ?? "none"}`);
    }
  }
});

test("small and quick", async (t) => {
  const { body } = await sent("thetahat_web_bg.wasm", "br");
  assert.ok(body.length < LARGEST_WASM, `${body.length} bytes`);
  const { body: space } = await sent("robot3d.js", "br");
  assert.ok(space.length < LARGEST_SPACE, `${space.length} bytes`);
  for (const [name, of] of [["page.js", "preact"], ["robot3d.js", "three"]]) {
    assert.match(readFileSync(join(REPOSITORY, "web/dist", name), "utf8"), new RegExp(`^/\\*! ${of}:\\n.*MIT License`), "the licence comes with the script");
  }
  const { page, close } = await visit(site);
  t.after(close);
  const shown = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
  t.diagnostic(`first view after ${Math.round(shown)} ms`);
  assert.ok(shown < FIRST_VIEW, `${shown} ms`);
});
