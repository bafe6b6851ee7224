// The triangles of STL, OBJ, DAE and glTF files. Pictures on surfaces are left out: the page loads none.

import { BufferGeometry, LoadingManager, Mesh, type Object3D } from "three";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { extensionOf, fileFor } from "../meshes";
import { withoutPictures } from "./gltf";

/** One grey point stands for every picture that a file names. */
const PICTURE = "data:image/gif;base64,R0lGODlhAQABAIAAAMzMzAAAACH5BAAAAAAALAAAAAABAAEAAAICRAEAOw==";

/** The surfaces of a file in the file's own axes, m. */
export async function surfacesOf(path: string, file: Blob, files: ReadonlyMap<string, Blob>): Promise<BufferGeometry[]> {
  switch (extensionOf(path)) {
    case "stl": return [bare(new STLLoader().parse(await file.arrayBuffer()))];
    case "obj": return surfacesIn(new OBJLoader().parse(await file.text()));
    case "dae": return surfacesIn(await collada(file));
    default: return surfacesIn(await gltf(path, file, files));
  }
}

/** The scene as the file has it: its z stays z, as other programs for URDF take it, whatever axis it says is up. */
async function collada(file: Blob): Promise<Object3D> {
  const manager = new LoadingManager();
  manager.setURLModifier(() => PICTURE);
  const text = (await file.text()).replace(/(<up_axis>\s*)[XZ]_UP/, "$1Y_UP");
  const parsed = new ColladaLoader(manager).parse(text, "");
  if (!parsed) throw new Error("it is no COLLADA file");
  return parsed.scene;
}

async function gltf(path: string, file: Blob, files: ReadonlyMap<string, Blob>): Promise<Object3D> {
  const neighbour = async (name: string) => {
    const found = fileFor(name, path, files);
    if (found === null) throw new Error(`${name} is missing`);
    return new Uint8Array(await files.get(found)!.arrayBuffer());
  };
  const packed = await withoutPictures(await file.arrayBuffer(), neighbour);
  const { scene } = await new GLTFLoader().parseAsync(packed, "");
  return scene;
}

function surfacesIn(object: Object3D): BufferGeometry[] {
  object.updateMatrixWorld(true);
  const found: BufferGeometry[] = [];
  object.traverse((part) => {
    if (part instanceof Mesh) found.push(bare((part.geometry as BufferGeometry).clone().applyMatrix4(part.matrixWorld)));
  });
  return found;
}

/** Triangles with directions alone. */
function bare(surface: BufferGeometry): BufferGeometry {
  for (const name of Object.keys(surface.attributes)) if (name !== "position" && name !== "normal") surface.deleteAttribute(name);
  if (!surface.getAttribute("position")) throw new Error("a surface has no points");
  if (!surface.getAttribute("normal")) surface.computeVertexNormals();
  return surface;
}
