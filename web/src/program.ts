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
  return Promise.all([textOf("worker-script"), unpacked("wasm").then((bytes) => WebAssembly.compile(bytes))]);
}

function textOf(id: string): string {
  return document.getElementById(id)?.textContent ?? "";
}

/** The bytes of a data block of the page, gzip in base64. */
function unpacked(id: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(textOf(id)), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

declare global {
  /** What the script of the drawing in space sets. */
  var robot3d: typeof import("./scene") | undefined;
}

/** The drawing in space, loaded when it is first asked for. */
export async function loadScene(): Promise<typeof import("./scene")> {
  if (!globalThis.robot3d) await (SINGLE_FILE ? sceneInside() : sceneOfServer());
  if (!globalThis.robot3d) throw new Error("the drawing in 3D did not start");
  return globalThis.robot3d;
}

function sceneOfServer(): Promise<void> {
  const script = document.createElement("script");
  script.src = "robot3d.js";
  return new Promise((resolve, reject) => {
    script.onload = () => resolve();
    script.onerror = () => reject(new Error("robot3d.js was not found on the server"));
    document.head.append(script);
  });
}

/** The page's policy allows a script with this text. */
async function sceneInside(): Promise<void> {
  const script = document.createElement("script");
  script.textContent = new TextDecoder().decode(await unpacked("robot3d"));
  document.head.append(script);
}
