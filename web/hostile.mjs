// Puts damaged files before the module in Node: each must end in an answer or an error. A trap is told, and a new module takes its place.
//
//   node web/hostile.mjs COUNT FILE...
//
// Of each file COUNT copies are made, cut or with bytes changed, from a fixed seed. Exits with 1 where a module gives neither.

import { readFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const FOLDER = join(dirname(fileURLToPath(import.meta.url)), "wasm");
const wasm = new WebAssembly.Module(readFileSync(join(FOLDER, "thetahat_web_bg.wasm")));
const [count, ...files] = process.argv.slice(2);
if (!(Number(count) > 0) || files.length === 0) {
  console.error("node web/hostile.mjs COUNT FILE...: give how many copies to make, and of which files");
  process.exit(2);
}

let instances = 0;
/** A module of its own: each import of another address has its own memory. */
async function fresh() {
  const glue = await import(`./wasm/thetahat_web.js?${instances++}`);
  glue.initSync({ module: wasm });
  return glue;
}

let state = 20261122;
const random = (below) => {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
  return Math.floor((state / 2 ** 32) * below);
};

function damaged(bytes) {
  if (random(4) === 0) return bytes.slice(0, random(bytes.length));
  const copy = new Uint8Array(bytes);
  // Descriptions stand at both ends of most formats.
  const places = [() => random(copy.length), () => random(Math.min(1024, copy.length)), () => copy.length - 1 - random(Math.min(4096, copy.length))];
  for (let k = 0; k <= random(8); k++) copy[places[random(3)]()] = [0, 1, 127, 128, 255, random(256)][random(6)];
  return copy;
}

let glue = await fresh();
let failed = false;
for (const file of files) {
  const [bytes, name, seen] = [readFileSync(file), basename(file), { answers: 0, errors: 0, traps: 0 }];
  const isRobot = /\.(urdf|toml)$/.test(name);
  const request = JSON.stringify(isRobot ? { robot: name } : { recordings: [name] });
  const traps = new Set();
  for (let k = 0; k < Number(count); k++) {
    const session = new glue.Session(1);
    try {
      session.put(name, damaged(bytes));
      session.kind(name);
      const answer = JSON.parse(session.understand(request));
      seen[answer.robot_error || answer.recording_errors.length > 0 ? "errors" : "answers"] += 1;
      session.remove(name);
    } catch (error) {
      if (error.constructor === Error) seen.errors += 1;
      else {
        seen.traps += 1;
        traps.add(glue.last_panic() || String(error));
        failed ||= !(error instanceof WebAssembly.RuntimeError);
        glue = await fresh();
      }
    }
  }
  console.log(`${name}: ${seen.answers} read all the same, ${seen.errors} errors, ${seen.traps} traps`);
  for (const trap of traps) console.log(`  ${trap}`);
}
process.exit(failed ? 1 : 0);
