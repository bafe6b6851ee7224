// Holds the session: all of thetahat runs here, so that the page never waits. Or it is one of the session's threads.

import { initSync, last_panic, serve_thread, Session, start_threads } from "thetahat-web";
import type { FromWorker, Method, ToWorker } from "./contract";

let session: Session | null = null;

addEventListener("message", ({ data }: MessageEvent<ToWorker>) => {
  try {
    if ("memory" in data) serve(data.module, data.memory);
    else if ("module" in data) start(data.module, data.threads);
    else run(data.call, data.method, data.args);
  } catch (error) {
    reply({ trap: panicOf(error) });
  }
});

function start(module: WebAssembly.Module, threads: number): void {
  const { memory } = initSync({ module });
  if (threads > 1) {
    reply({ memory });
    start_threads(threads);
  }
  session = new Session(threads);
}

/** Works on the memory of the session until the page ends this worker. */
function serve(module: WebAssembly.Module, memory: WebAssembly.Memory): void {
  initSync({ module, memory });
  serve_thread();
}

/** Answers one call. An error with the message of the command line is a plain `Error`; everything else is a trap. */
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
    case "apply": return session.apply(first, second, third);
    case "changed": return session.changed(first, second);
    case "sample": return session.sample(first);
    case "export": return session.export(first, second, third);
    case "bodies": return session.bodies(first);
    case "urdf": return session.urdf(first);
  }
}

/** The program's own words; without any, a trap is an allocation that the browser refused. */
function panicOf(error: unknown): string {
  return last_panic() || (error instanceof WebAssembly.RuntimeError ? `the browser gave no more memory (${error.message})` : String(error));
}

function reply(message: FromWorker): void {
  postMessage(message);
}
