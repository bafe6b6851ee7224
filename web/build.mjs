// Makes web/dist: the page for a web server, and thetahat.html, which is all of it in one file. The wasm is made by `web/build`.

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { brotliCompress, gzip, gzipSync } from "node:zlib";
import { build } from "esbuild";
import { demoResult } from "./demo_result.mjs";

const HERE = dirname(fileURLToPath(import.meta.url));
const DIST = join(HERE, "dist");
/** The modules: one thread, and several on one memory. */
const WASM = { one: join(HERE, "wasm"), threads: join(HERE, "wasm/threads") };
const REPORT = join(HERE, "../crates/thetahat-report/src/report/page");

const read = (path) => readFileSync(path, "utf8");

/** What the page says of the program. */
const [, CARGO_VERSION] = /^version = "(.+)"$/m.exec(read(join(HERE, "../Cargo.toml")));
const [, REPOSITORY] = /^repository = "(.+)"$/m.exec(read(join(HERE, "../Cargo.toml")));
const hashOf = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

/** The script of every report as it stands in its page. */
const REPORT_SCRIPT = `\n${read(join(REPORT, "script.js"))}\n`;

/** The text of an entry, bundled. */
async function bundle(entry, { define = {}, alias = {}, globalName, banner = "" } = {}) {
  const { outputFiles } = await build({
    entryPoints: [join(HERE, "src", entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2022",
    legalComments: "none",
    jsx: "automatic",
    jsxImportSource: "preact",
    define: { "import.meta.url": '""', ...define },
    alias,
    banner: { js: banner },
    ...(globalName ? { globalName } : {}),
  });
  return outputFiles[0].text;
}

/** The licence of a package, for the script that contains it. */
const licence = (name) => `/*! ${name}:\n${read(join(HERE, "node_modules", name, "LICENSE")).trim()}\n*/`;

/** What the page may load and run: its own files, the wasm, and the script of the report that it shows. */
function policy({ scripts, connect }) {
  return [
    "default-src 'none'",
    `script-src ${[...scripts, "'wasm-unsafe-eval'", hashOf(REPORT_SCRIPT)].join(" ")}`,
    "style-src 'self' 'unsafe-inline'",
    "img-src data:",
    `connect-src ${connect}`,
    // The worker is a blob, so that this policy holds for it too; beside it there is the service worker.
    "worker-src 'self' blob:",
    "frame-src blob:",
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");
}

/** The page with its policy, style and scripts; functions, since texts may hold `$`. */
function page({ policy, style, scripts }) {
  return read(join(HERE, "src/index.html"))
    .replace("<!-- policy -->", () => policy)
    .replace("<!-- style -->", () => style)
    .replace("<!-- scripts -->", () => scripts);
}

/** A script inside a page must not hold its own end. */
const inline = (script) => script.replaceAll("</script", "<\\/script");

/** The worker's script for a module. */
const workerOf = (folder) => bundle("worker.ts", { alias: { "thetahat-web": join(folder, "thetahat_web.js") } });
const wasmOf = (folder) => readFileSync(join(folder, "thetahat_web_bg.wasm"));

async function served(style, worker, wasm, robot3d) {
  const script = await pageScript("false");
  const html = page({
    policy: policy({ scripts: ["'self'"], connect: "'self'" }),
    style: '<link rel="stylesheet" href="page.css">',
    scripts: '<script src="page.js"></script>',
  });
  const shown = { "index.html": html, "page.css": style, "page.js": script, "robot3d.js": robot3d };
  const one = { "worker.js": worker, "thetahat_web_bg.wasm": wasm };
  const threads = { "threads/worker.js": await workerOf(WASM.threads), "threads/thetahat_web_bg.wasm": wasmOf(WASM.threads) };
  mkdirSync(join(DIST, "threads"));
  const files = { ...shown, ...one, ...threads };
  for (const [name, content] of Object.entries(files)) writeFileSync(join(DIST, name), content);
  await Promise.all(Object.entries(files).map(([name, content]) => pack(join(DIST, name), content)));
  writeFileSync(join(DIST, "sw.js"), await serviceWorker({ ...shown, ...one }));
  writeFileSync(join(DIST, "sw_threads.js"), await serviceWorker({ ...shown, ...threads }));
}

/** Beside a file what a server may send in its place, the smallest that takes no work at each visit. */
async function pack(path, content) {
  const [gz, br] = await Promise.all([promisify(gzip)(content, { level: 9 }), promisify(brotliCompress)(content)]);
  writeFileSync(`${path}.gz`, gz);
  writeFileSync(`${path}.br`, br);
}

/** A service worker that keeps files. */
function serviceWorker(files) {
  const hash = createHash("sha256");
  for (const content of Object.values(files)) hash.update(content).update("\0");
  const version = `thetahat-${hash.digest("hex").slice(0, 16)}`;
  const kept = ["./", ...Object.keys(files)];
  return bundle("sw.ts", { define: { VERSION: JSON.stringify(version), FILES: JSON.stringify(kept) } });
}

function pageScript(isSingleFile) {
  return bundle("main.tsx", { define: { ...ABOUT, SINGLE_FILE: isSingleFile }, banner: licence("preact") });
}

async function singleFile(style, worker, wasm, robot3d) {
  const script = inline(await pageScript("true"));
  const packed = (bytes) => gzipSync(bytes, { level: 9 }).toString("base64");
  const data = (id, text) => `<script type="text/plain" id="${id}">${text}</script>`;
  const html = page({
    policy: policy({ scripts: [hashOf(script), hashOf(robot3d)], connect: "'none'" }),
    style: `<style>${style}</style>`,
    scripts: [
      data("worker-script", inline(worker)),
      data("wasm", packed(wasm)),
      data("robot3d", packed(robot3d)),
      `<script>${script}</script>`,
    ].join("\n"),
  });
  writeFileSync(join(DIST, "thetahat.html"), html);
}

const ABOUT = {
  VERSION: JSON.stringify(CARGO_VERSION),
  REPOSITORY: JSON.stringify(REPOSITORY),
  DEMO_RESULT: JSON.stringify(await demoResult(WASM.one)),
};
rmSync(DIST, { recursive: true, force: true });
mkdirSync(DIST, { recursive: true });
const [style, worker, wasm] = [await bundle("page.css"), await workerOf(WASM.one), wasmOf(WASM.one)];
const robot3d = await bundle("scene/index.ts", { globalName: "robot3d", banner: licence("three") });
await served(style, worker, wasm, robot3d);
await singleFile(style, worker, wasm, robot3d);
