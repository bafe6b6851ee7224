// The robot without meshes: a cylinder about each axis that turns, a box on each that slides, and boxes from joint to joint.

import { BoxGeometry, CylinderGeometry, Group, Mesh, Quaternion, Vector3, type BufferGeometry } from "three";
import type { Point, Rotation, Skeleton } from "../contract";
import type { Materials } from "./materials";

const Z = new Vector3(0, 0, 1);
/** Along z, with its centre at zero. */
const ROUND = new CylinderGeometry(0.75, 0.75, 2, 20).rotateX(Math.PI / 2);
const SQUARE = new BoxGeometry(1.1, 1.1, 2.6);
const LINK = new BoxGeometry(1, 1, 1);

/** A box from one point to another, of a link. */
interface Bar {
  /** The link that it is of; null is the base. */
  link: number | null;
  mesh: Mesh;
  ends: (origins: Point[], rotations: Rotation[]) => [Point, Point];
}

const BASE: Point = [0, 0, 0];

export class Boxes {
  readonly group = new Group();
  private readonly joints: Mesh[];
  private readonly bars: Bar[];

  constructor(private readonly skeleton: Skeleton, private readonly width: number, private readonly materials: Materials) {
    this.joints = skeleton.joints.map(({ kind }, joint) => this.part(kind === "prismatic" ? SQUARE : ROUND, joint));
    for (const mesh of this.joints) mesh.scale.setScalar(width);
    const between = skeleton.joints.map(({ parent }, joint) => this.bar(parent, (origins) => [parent === null ? BASE : origins[parent]!, origins[joint]!]));
    this.bars = [...between, ...this.tips()];
  }

  show(origins: Point[], rotations: Rotation[]): void {
    this.joints.forEach((mesh, joint) => {
      mesh.position.set(...origins[joint]!);
      mesh.quaternion.setFromUnitVectors(Z, new Vector3(...turned(rotations[joint]!, this.skeleton.joints[joint]!.axis)).normalize());
    });
    for (const { mesh, ends } of this.bars) stretch(mesh, ends(origins, rotations), this.width);
  }

  /** Hides what is of these links; null is the base. */
  hide(links: ReadonlySet<number | null>): void {
    this.joints.forEach((mesh, joint) => { mesh.visible = !links.has(joint); });
    for (const { link, mesh } of this.bars) mesh.visible = !links.has(link);
  }

  /** From the last joints to the centres of mass of their links. */
  private tips(): Bar[] {
    const carriers = new Set(this.skeleton.joints.map(({ parent }) => parent));
    const last = this.skeleton.joints.map((_, joint) => joint).filter((joint) => !carriers.has(joint));
    return last.flatMap((joint) => {
      const body = this.skeleton.bodies[joint]?.body;
      if (!body) return [];
      return [this.bar(joint, (origins, rotations) => {
        const [from, way] = [origins[joint]!, turned(rotations[joint]!, body.centre)];
        return [from, [from[0] + way[0], from[1] + way[1], from[2] + way[2]]];
      })];
    });
  }

  private bar(link: number | null, ends: Bar["ends"]): Bar {
    return { link, mesh: this.part(LINK, link), ends };
  }

  private part(geometry: BufferGeometry, link: number | null): Mesh {
    const mesh = new Mesh(geometry, this.materials.of(link));
    this.group.add(mesh);
    return mesh;
  }
}

function turned(rotation: Rotation, [x, y, z]: Point): Point {
  return rotation.map(([a, b, c]) => a * x + b * y + c * z) as Point;
}

/** Places a box between two points. */
function stretch(mesh: Mesh, [from, to]: [Point, Point], width: number): void {
  const [a, b] = [new Vector3(...from), new Vector3(...to)];
  const way = b.clone().sub(a);
  const length = way.length();
  mesh.position.copy(a).add(b).multiplyScalar(0.5);
  mesh.scale.set(width, width, Math.max(length, 1e-6));
  mesh.quaternion.copy(length > 1e-9 ? new Quaternion().setFromUnitVectors(Z, way.normalize()) : new Quaternion());
}
