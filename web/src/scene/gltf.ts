// A glTF file in one piece, without pictures and materials.

/** The parts of a glTF that are read here. */
interface Gltf {
  buffers?: { uri?: string; byteLength: number }[];
  bufferViews?: { buffer: number; byteOffset?: number }[];
  meshes?: { primitives: { material?: number }[] }[];
  materials?: unknown;
  textures?: unknown;
  images?: unknown;
  samplers?: unknown;
}

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;

/** The file as one that names no other; `neighbour` reads a file next to it. */
export async function withoutPictures(file: ArrayBuffer, neighbour: (name: string) => Promise<Uint8Array>): Promise<ArrayBuffer> {
  const { text, binary } = partsOf(file);
  const gltf = JSON.parse(text) as Gltf;
  const buffers = await Promise.all((gltf.buffers ?? []).map(({ uri }) => (uri === undefined ? binary : bytesOf(uri, neighbour))));
  for (const key of ["materials", "textures", "images", "samplers"] as const) delete gltf[key];
  for (const primitive of (gltf.meshes ?? []).flatMap(({ primitives }) => primitives)) delete primitive.material;
  const starts = startsOf(buffers);
  for (const view of gltf.bufferViews ?? []) {
    view.byteOffset = (view.byteOffset ?? 0) + (starts[view.buffer] ?? 0);
    view.buffer = 0;
  }
  const length = starts.at(-1)!;
  if (length > 0) gltf.buffers = [{ byteLength: length }];
  return joined(gltf, buffers, starts);
}

function partsOf(file: ArrayBuffer): { text: string; binary: Uint8Array } {
  const view = new DataView(file);
  if (file.byteLength < 20 || view.getUint32(0, true) !== MAGIC) return { text: new TextDecoder().decode(file), binary: new Uint8Array() };
  const length = view.getUint32(12, true);
  const text = new TextDecoder().decode(new Uint8Array(file, 20, length));
  const second = 20 + length + 8;
  return { text, binary: second <= file.byteLength ? new Uint8Array(file, second, view.getUint32(second - 8, true)) : new Uint8Array() };
}

async function bytesOf(uri: string, neighbour: (name: string) => Promise<Uint8Array>): Promise<Uint8Array> {
  const [, base64] = /^data:[^,]*;base64,(.*)$/s.exec(uri) ?? [];
  return base64 === undefined ? neighbour(decodeURIComponent(uri)) : Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

/** Where each buffer begins in one of all, and where the last ends; four bytes belong together. */
function startsOf(buffers: Uint8Array[]): number[] {
  const starts = [0];
  for (const { byteLength } of buffers) starts.push(starts.at(-1)! + padded(byteLength));
  return starts;
}

function padded(length: number): number {
  return (length + 3) & ~3;
}

function joined(gltf: Gltf, buffers: Uint8Array[], starts: number[]): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(gltf));
  const [textLength, length] = [padded(text.byteLength), starts.at(-1)!];
  const all = new Uint8Array(20 + textLength + 8 + length).fill(0x20, 20, 20 + textLength);
  const view = new DataView(all.buffer);
  [MAGIC, 2, all.byteLength, textLength, JSON_CHUNK].forEach((word, k) => view.setUint32(4 * k, word, true));
  all.set(text, 20);
  view.setUint32(20 + textLength, length, true);
  view.setUint32(24 + textLength, BINARY_CHUNK, true);
  buffers.forEach((bytes, k) => all.set(bytes, 28 + textLength + starts[k]!));
  return all.buffer;
}
