// Makes web/dist: the page for a web server, and thetahat.html, which is all of it in one file. The wasm is made by `web/build`.

import { createHash } from "node:crypto";
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const HERE = dirname(fileURLToPath(import.meta.url));
const DIST = join(HERE, "dist");
const WASM = join(HERE, "wasm/thetahat_web_bg.wasm");
const REPORT = join(HERE, "../crates/thetahat/src/report/page");

const read = (path) => readFileSync(path, "utf8");
const hashOf = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

/** The script of every report as it stands in its page. */
const REPORT_SCRIPT = `\n${read(join(REPORT, "script.js"))}\n`;

/** The text of an entry, bundled. */
async function bundle(entry, define = {}) {
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
  });
  return outputFiles[0].text;
}

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

async function served(style, worker, wasm) {
  const script = await bundle("main.tsx", { SINGLE_FILE: "false" });
  const html = page({
    policy: policy({ scripts: ["'self'"], connect: "'self'" }),
    style: '<link rel="stylesheet" href="page.css">',
    scripts: '<script src="page.js"></script>',
  });
  const files = { "index.html": html, "page.css": style, "page.js": script, "worker.js": worker };
  for (const [name, text] of Object.entries(files)) writeFileSync(join(DIST, name), text);
  cpSync(WASM, join(DIST, "thetahat_web_bg.wasm"));
  const content = createHash("sha256").update(Object.values(files).join("\0")).update(wasm).digest("hex").slice(0, 16);
  const kept = ["./", "thetahat_web_bg.wasm", ...Object.keys(files)];
  const define = { VERSION: JSON.stringify(`thetahat-${content}`), FILES: JSON.stringify(kept) };
  writeFileSync(join(DIST, "sw.js"), await bundle("sw.ts", define));
}

async function singleFile(style, worker, wasm) {
  const script = inline(await bundle("main.tsx", { SINGLE_FILE: "true" }));
  const data = (id, text) => `<script type="text/plain" id="${id}">${text}</script>`;
  const html = page({
    policy: policy({ scripts: [hashOf(script)], connect: "'none'" }),
    style: `<style>${style}</style>`,
    scripts: [
      data("worker-script", inline(worker)),
      data("wasm", gzipSync(wasm, { level: 9 }).toString("base64")),
      `<script>${script}</script>`,
    ].join("\n"),
  });
  writeFileSync(join(DIST, "thetahat.html"), html);
}

rmSync(DIST, { recursive: true, force: true });
mkdirSync(DIST, { recursive: true });
const [style, worker] = [await bundle("page.css"), await bundle("worker.ts")];
const wasm = readFileSync(WASM);
await served(style, worker, wasm);
await singleFile(style, worker, wasm);
