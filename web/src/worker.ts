// Holds the session: all of thetahat runs here, so that the page never waits.

import { initSync, last_panic, Session } from "../wasm/thetahat_web.js";
import type { FromWorker, Method, ToWorker } from "./contract";

let session: Session | null = null;

addEventListener("message", ({ data }: MessageEvent<ToWorker>) => {
  try {
    if ("module" in data) start(data.module);
    else run(data.call, data.method, data.args);
  } catch (error) {
    reply({ trap: panicOf(error) });
  }
});

function start(module: WebAssembly.Module): void {
  initSync({ module });
  session = new Session();
}

/** Answers one call. What the command line would print comes as a plain `Error`; everything else is a trap. */
function run(call: number, method: Method, args: unknown[]): void {
  if (session === null) throw new Error("the session has not started");
  const stage = (text: string) => reply({ call, stage: text });
  try {
    reply({ call, answer: answerOf(session, method, args, stage) });
  } catch (error) {
    if (!(error instanceof Error) || error.constructor !== Error) throw error;
    reply({ call, error: error.message });
  }
}

function answerOf(session: Session, method: Method, args: unknown[], stage: (text: string) => void): string {
  const [first, second, third] = args as [string, never, never];
  switch (method) {
    case "put": session.put(first, second); return "";
    case "remove": session.remove(first); return "";
    case "kind": return session.kind(first);
    case "understand": return session.understand(first);
    case "propose": return session.propose(first, stage);
    case "identify": return session.identify(first, stage);
    case "demo": return session.demo();
    case "export": return session.export(first, second, third);
  }
}

function panicOf(error: unknown): string {
  return last_panic() || String(error);
}

function reply(message: FromWorker): void {
  postMessage(message);
}
