// The files of a zip archive, read with the browser's own decompression.

import type { GivenFile } from "./app";

/** Largest number of files, and of bytes of all. */
const MOST = { files: 2000, bytes: 400 * 2 ** 20 };
const END = 0x06054b50;
const ENTRY = 0x02014b50;
/** Bytes before the names: of the end of the archive, of an entry of its list, and of a file. */
const HEADER = { end: 22, entry: 46, file: 30 };

interface Entry {
  path: string;
  method: number;
  packed: number;
  bytes: number;
  start: number;
}

/** The files of an archive that are wanted, each with its path in it. */
export async function unzipped(archive: Blob, isWanted: (path: string) => boolean): Promise<GivenFile[]> {
  const entries = (await entriesOf(archive)).filter(({ path }) => !path.endsWith("/") && isWanted(path));
  const bytes = entries.reduce((sum, entry) => sum + entry.bytes, 0);
  if (entries.length > MOST.files || bytes > MOST.bytes) {
    throw new Error(`${entries.length} files of ${Math.round(bytes / 2 ** 20)} MiB, more than ${MOST.files} of ${MOST.bytes / 2 ** 20} MiB`);
  }
  return Promise.all(entries.map(async (entry) => ({ path: entry.path, file: new File([await contentOf(archive, entry)], entry.path) })));
}

async function viewOf(archive: Blob, start: number, end: number): Promise<DataView> {
  return new DataView(await archive.slice(start, end).arrayBuffer());
}

async function entriesOf(archive: Blob): Promise<Entry[]> {
  const tail = await viewOf(archive, Math.max(0, archive.size - HEADER.end - 0xffff), archive.size);
  let end = tail.byteLength - HEADER.end;
  while (end >= 0 && tail.getUint32(end, true) !== END) end -= 1;
  if (end < 0) throw new Error("it is no zip archive");
  const [count, length, start] = [tail.getUint16(end + 10, true), tail.getUint32(end + 12, true), tail.getUint32(end + 16, true)];
  if (start === 0xffffffff) throw new Error("it is a zip archive of more than 4 GiB");
  return listed(await viewOf(archive, start, start + length), count);
}

function listed(list: DataView, count: number): Entry[] {
  const entries: Entry[] = [];
  let at = 0;
  while (entries.length < count && at + HEADER.entry <= list.byteLength && list.getUint32(at, true) === ENTRY) {
    const [name, extra, comment] = [28, 30, 32].map((place) => list.getUint16(at + place, true)) as [number, number, number];
    const [packed, bytes, start] = [20, 24, 42].map((place) => list.getUint32(at + place, true)) as [number, number, number];
    const path = new TextDecoder().decode(new Uint8Array(list.buffer, at + HEADER.entry, Math.min(name, list.byteLength - at - HEADER.entry)));
    entries.push({ path, method: list.getUint16(at + 10, true), packed, bytes, start });
    at += HEADER.entry + name + extra + comment;
  }
  if (entries.length < count) throw new Error("its list of files is broken");
  return entries;
}

async function contentOf(archive: Blob, { path, method, packed, bytes, start }: Entry): Promise<Blob> {
  const header = await viewOf(archive, start, start + HEADER.file);
  const begin = start + HEADER.file + header.getUint16(26, true) + header.getUint16(28, true);
  const content = archive.slice(begin, begin + packed);
  if (method === 0) return content;
  if (method !== 8) throw new Error(`${path} is packed in a way that browsers do not read`);
  return unpacked(content.stream().pipeThrough(new DecompressionStream("deflate-raw")), path, bytes);
}

/** The content of a stream, no longer than the archive says. */
async function unpacked(stream: ReadableStream<Uint8Array<ArrayBuffer>>, path: string, bytes: number): Promise<Blob> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let length = 0;
  const reader = stream.getReader();
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    length += next.value.byteLength;
    if (length > bytes) throw new Error(`${path} is longer than the archive says`);
    parts.push(next.value);
  }
  return new Blob(parts);
}
