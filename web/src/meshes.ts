// Files of surfaces next to a robot: which they are, and which of them a description names.

const SURFACES = ["stl", "obj", "dae", "gltf", "glb"];
/** What those files name in turn. */
const PARTS = ["bin"];

export const MESHES = SURFACES.map((extension) => `.${extension}`).join(",");

export function extensionOf(path: string): string {
  return /\.([^./]+)$/.exec(path)?.[1]?.toLowerCase() ?? "";
}

/** Whether a file is drawn alone, and not read by the program. */
export function isMesh(path: string): boolean {
  return [...SURFACES, ...PARTS].includes(extensionOf(path));
}

/** The path of the file that a description at `origin` names: the one that has most folders at its end in common with the name. */
export function fileFor(name: string, origin: string, files: ReadonlyMap<string, Blob>): string | null {
  const wanted = partsOf(name.replace(/^[a-z]+:\/\//i, ""));
  const own = partsOf(`${origin.replace(/[^/]*$/, "")}${name}`).join("/");
  if (files.has(own)) return own;
  let [best, most] = [null as string | null, 0];
  for (const path of files.keys()) {
    const parts = partsOf(path);
    const shared = sharedEnd(parts, wanted);
    // A file in another folder is another file; one that was chosen alone has no folder.
    const isSame = shared >= Math.min(2, parts.length, wanted.length);
    if (isSame && shared > most) [best, most] = [path, shared];
  }
  return best;
}

/** The folders of a path and its file, without those that it leaves again. */
function partsOf(path: string): string[] {
  const parts: string[] = [];
  for (const part of path.split(/[/\\]+/)) {
    if (part === "..") parts.pop();
    else if (part !== "." && part !== "") parts.push(part);
  }
  return parts;
}

function sharedEnd(a: string[], b: string[]): number {
  let shared = 0;
  while (shared < Math.min(a.length, b.length) && a.at(-1 - shared)!.toLowerCase() === b.at(-1 - shared)!.toLowerCase()) shared += 1;
  return shared;
}
