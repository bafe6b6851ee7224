// A static server of web/dist on localhost, with the headers that a server of this page should send.

import { createReadStream, existsSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const DIST = join(dirname(fileURLToPath(import.meta.url)), "dist");
const TYPES = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".wasm": "application/wasm",
};
const HEADERS = {
  "Cross-Origin-Opener-Policy": "same-origin",
  "Cross-Origin-Embedder-Policy": "require-corp",
  "X-Content-Type-Options": "nosniff",
  "Referrer-Policy": "no-referrer",
  "Cache-Control": "no-cache",
};

/** The path of an address; none where it is no address. */
function pathOf(url) {
  try {
    return normalize(decodeURIComponent(new URL(url, "http://localhost").pathname));
  } catch {
    return null;
  }
}

/** The file behind a path; none where there is no such file. */
function fileOf(path, folder) {
  if (path.includes("\0")) return null;
  const file = join(folder, path.endsWith("/") ? `${path}index.html` : path);
  return file.startsWith(folder) && statSync(file, { throwIfNoEntry: false })?.isFile() ? file : null;
}

/** The packed forms that `web/build` leaves beside a file, the smallest first: what a browser calls each, and how its name ends. */
const PACKED = { br: ".br", gzip: ".gz" };

/** The form of a file that a request accepts, and the header that names it. */
function formOf(file, request) {
  const offered = (request.headers["accept-encoding"] ?? "").split(",").filter((coding) => !/;\s*q=0(\.0*)?\s*$/.test(coding));
  const accepted = offered.map((coding) => coding.split(";")[0].trim());
  const coding = Object.keys(PACKED).find((coding) => accepted.includes(coding) && existsSync(file + PACKED[coding]));
  return coding ? { path: file + PACKED[coding], encoding: { "Content-Encoding": coding } } : { path: file, encoding: {} };
}

/** A server that listens on localhost alone; port 0 takes any that is free. */
export function serve(port = 8000, { folder = DIST, headers = HEADERS } = {}) {
  const server = createServer((request, response) => {
    const asked = pathOf(request.url);
    if (asked === null) return response.writeHead(400, headers).end("not an address\n");
    const file = fileOf(asked, folder);
    if (!file) return response.writeHead(404, headers).end("not found\n");
    const { path, encoding } = formOf(file, request);
    const type = TYPES[extname(file)] ?? "application/octet-stream";
    response.writeHead(200, { ...headers, ...encoding, "Content-Type": type, Vary: "Accept-Encoding" });
    return createReadStream(path).on("error", () => response.destroy()).pipe(response);
  });
  return new Promise((resolve, reject) => {
    server.on("error", reject).listen(port, "127.0.0.1", () => resolve(server));
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const server = await serve(Number(process.argv[2] ?? 8000));
  console.log(`http://localhost:${server.address().port}/`);
}
