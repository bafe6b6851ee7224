// The links of a URDF as it draws them, from the files next to it.

import { BoxGeometry, type BufferGeometry, CylinderGeometry, Group, Mesh, SphereGeometry } from "three";
import type { Skeleton } from "../contract";
import { fileFor } from "../meshes";
import { surfacesOf } from "./loaders";
import type { Materials } from "./materials";
import { simpler } from "./simpler";
import { visualsOf, type Visual } from "./visuals";

/** A URDF and the files next to it. */
export interface Given {
  urdf: string;
  /** Its path. */
  path: string;
  files: ReadonlyMap<string, Blob>;
  /** Joints that do not move, with their values. */
  locked: ReadonlyMap<string, number>;
}

/** What was drawn of a URDF. */
export interface Described {
  /** Files that are read. */
  files: number;
  triangles: number;
  /** The joints whose links are drawn whole; null is the base. */
  links: ReadonlySet<number | null>;
  /** Files that are not there. */
  missing: string[];
  /** Files that cannot be read, and why. */
  unreadable: { file: string; why: string }[];
}

interface DrawnLinks {
  links: { joint: number | null; group: Group }[];
  described: Described;
}

/** Largest number of triangles of all meshes. */
const MOST_TRIANGLES = 5e6;

/** The links that a URDF draws; details below `finest`, m, are left out where it is not null. */
export async function meshesOf(given: Given, skeleton: Skeleton, materials: Materials, finest: number | null): Promise<DrawnLinks> {
  const visuals = visualsOf(given.urdf, skeleton, given.locked);
  const surfaces = new Surfaces(given, finest);
  const groups = new Map<number | null, Group>();
  const broken = new Set<number | null>();
  for (const visual of visuals) {
    const parts = await surfaces.of(visual);
    if (!parts) broken.add(visual.joint);
    const group = groups.get(visual.joint) ?? new Group();
    groups.set(visual.joint, group);
    for (const part of parts ?? []) group.add(placed(part, visual, materials));
  }
  const links = new Set([...groups.keys()].filter((joint) => !broken.has(joint)));
  return { links: [...groups].map(([joint, group]) => ({ joint, group })), described: { ...surfaces.found, links } };
}

function placed(surface: BufferGeometry, { joint, place, shape }: Visual, materials: Materials): Mesh {
  const mesh = new Mesh(surface, materials.of(joint));
  mesh.applyMatrix4(place);
  if (shape.kind === "mesh") mesh.scale.set(...shape.scale);
  return mesh;
}

/** The surfaces of files, each read once. */
class Surfaces {
  readonly found: Omit<Described, "links"> = { files: 0, triangles: 0, missing: [], unreadable: [] };
  private readonly read = new Map<string, Promise<BufferGeometry[] | null>>();

  constructor(private readonly given: Given, private readonly finest: number | null) {}

  /** The surfaces of a visual part; null where its file is missing or cannot be read. */
  of({ shape }: Visual): Promise<BufferGeometry[] | null> {
    switch (shape.kind) {
      case "box": return Promise.resolve([new BoxGeometry(...shape.size)]);
      case "sphere": return Promise.resolve([new SphereGeometry(shape.radius, 24, 16)]);
      case "cylinder": return Promise.resolve([new CylinderGeometry(shape.radius, shape.radius, shape.length, 24).rotateX(Math.PI / 2)]);
      case "mesh": {
        const known = this.read.get(shape.file) ?? this.ofFile(shape.file, Math.max(...shape.scale.map(Math.abs), 1e-9));
        this.read.set(shape.file, known);
        return known;
      }
    }
  }

  private async ofFile(name: string, scale: number): Promise<BufferGeometry[] | null> {
    const path = fileFor(name, this.given.path, this.given.files);
    if (path === null) {
      this.found.missing.push(name);
      return null;
    }
    try {
      const { finest } = this;
      // The page answers between two files.
      await new Promise((done) => setTimeout(done));
      const read = await surfacesOf(path, this.given.files.get(path)!, this.given.files);
      const surfaces = finest === null ? read : read.map((surface) => simpler(surface, finest / scale));
      this.count(surfaces);
      return surfaces;
    } catch (error) {
      this.found.unreadable.push({ file: name, why: error instanceof Error ? error.message : String(error) });
      return null;
    }
  }

  private count(surfaces: BufferGeometry[]): void {
    const triangles = surfaces.reduce((sum, surface) => sum + (surface.index ?? surface.getAttribute("position")).count / 3, 0);
    if (this.found.triangles + triangles > MOST_TRIANGLES) throw new Error(`with its ${Math.round(triangles)} triangles there are more than ${MOST_TRIANGLES}`);
    this.found.files += 1;
    this.found.triangles += triangles;
  }
}
