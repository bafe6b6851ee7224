// The worker's script and the wasm: separate files, or inside the page.

/** True in `thetahat.html`, which holds everything; esbuild sets it. */
declare const SINGLE_FILE: boolean;

/** Largest number of threads: each has its own stack. */
const MOST_THREADS = 16;

/** Several if the server's headers allow memory shared by workers. */
export const THREADS = !SINGLE_FILE && crossOriginIsolated ? Math.min(navigator.hardwareConcurrency, MOST_THREADS) : 1;

/** The parts that start a worker. */
export interface Program {
  /** The address of the script: a blob, so that the page's policy holds for the worker on any server. */
  script: string;
  module: WebAssembly.Module;
}

export async function loadProgram(): Promise<Program> {
  const [script, module] = await (SINGLE_FILE ? inside() : separate());
  return { script: URL.createObjectURL(new Blob([script], { type: "text/javascript" })), module };
}

type Parts = Promise<[string, WebAssembly.Module]>;

function separate(): Parts {
  const folder = THREADS > 1 ? "threads/" : "";
  const script = fetch(`${folder}worker.js`).then((answer) => answer.text());
  return Promise.all([script, WebAssembly.compileStreaming(fetch(`${folder}thetahat_web_bg.wasm`))]);
}

/** The script as text and the wasm as gzip in base64, each in a data block of the page. */
function inside(): Parts {
  return Promise.all([textOf("worker-script"), unpack(textOf("wasm"))]);
}

function textOf(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

async function unpack(base64: string): Promise<WebAssembly.Module> {
  const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const bytes = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}
