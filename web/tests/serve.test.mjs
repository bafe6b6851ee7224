// The small server.

import assert from "node:assert/strict";
import { once } from "node:events";
import { connect } from "node:net";
import { test } from "node:test";
import { serve } from "../serve.mjs";

/** The first line of the answer to a request for an address, as it is written. */
async function answer(server, address) {
  const socket = connect(server.address().port, "127.0.0.1");
  socket.end(`GET ${address} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n`);
  let text = "";
  socket.on("data", (part) => (text += part));
  await once(socket, "close");
  return text.split("\r\n")[0];
}

test("any address gets an answer", async (t) => {
  const server = await serve(0);
  t.after(() => server.close());
  for (const address of ["/%", "/%ff", "//", "/%00"]) {
    assert.match(await answer(server, address), /^HTTP\/1\.1 40[04] /, address);
  }
  assert.match(await answer(server, "/"), /^HTTP\/1\.1 (200|404) /);
});
