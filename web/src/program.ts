// Where the worker's script and the wasm are: beside the page, or inside it.

import type { Program } from "./client";

/** True in `thetahat.html`, which holds everything; esbuild sets it. */
declare const SINGLE_FILE: boolean;

export function loadProgram(): Program {
  return SINGLE_FILE ? inside() : beside();
}

function beside(): Program {
  const module = WebAssembly.compileStreaming(fetch("thetahat_web_bg.wasm"));
  return { spawn: () => new Worker("worker.js"), module };
}

/** The script as text and the wasm as gzip in base64, each in a data block of the page. */
function inside(): Program {
  const script = new Blob([textOf("worker-script")], { type: "text/javascript" });
  const url = URL.createObjectURL(script);
  return { spawn: () => new Worker(url), module: unpack(textOf("wasm")) };
}

function textOf(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

async function unpack(base64: string): Promise<WebAssembly.Module> {
  const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const bytes = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}
