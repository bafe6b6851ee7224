// What a URDF draws: the visual parts of its links, each in the frame of the joint of the skeleton that carries it.

import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import type { Skeleton } from "../contract";

export type Shape =
  | { kind: "mesh"; file: string; scale: [number, number, number] }
  | { kind: "box"; size: [number, number, number] }
  | { kind: "cylinder"; radius: number; length: number }
  | { kind: "sphere"; radius: number };

export interface Visual {
  link: string;
  /** The joint whose link carries it; null is the base. */
  joint: number | null;
  place: Matrix4;
  shape: Shape;
}

/** A joint of the URDF. */
interface UrdfJoint {
  name: string;
  kind: string;
  parent: string;
  origin: Matrix4;
  axis: Vector3;
}

/** Where a link is. */
interface Place {
  joint: number | null;
  place: Matrix4;
}

/** The visual parts of a URDF. Joints that are not in the skeleton stand at their locked values, or at zero. */
export function visualsOf(urdf: string, skeleton: Skeleton, locked: ReadonlyMap<string, number>): Visual[] {
  const robot = new DOMParser().parseFromString(urdf, "application/xml").documentElement;
  if (robot.tagName !== "robot") return [];
  const placeOf = placesIn(robot, skeleton, locked);
  return children(robot, "link").flatMap((element) => {
    const link = element.getAttribute("name") ?? "";
    return children(element, "visual").flatMap((visual) => {
      const shape = shapeOf(visual);
      if (!shape) return [];
      const { joint, place } = placeOf(link);
      return [{ link, joint, place: place.clone().multiply(originOf(visual)), shape }];
    });
  });
}

/** Where links are, by their names. */
function placesIn(robot: Element, skeleton: Skeleton, locked: ReadonlyMap<string, number>): (link: string) => Place {
  const joints = new Map(children(robot, "joint").map((element) => [child(element, "child")?.getAttribute("link") ?? "", jointOf(element)]));
  const numbers = new Map(skeleton.joints.map(({ name }, number) => [name, number]));
  const places = new Map<string, Place>();
  const root = rootOf(joints, numbers, skeleton);
  const placeOf = (link: string): Place => {
    const known = places.get(link);
    if (known) return known;
    const joint = joints.get(link);
    // Until it is known: a circle of joints ends here.
    places.set(link, root);
    const place = joint ? carried(joint, numbers.get(joint.name), placeOf, locked) : root;
    places.set(link, place);
    return place;
  };
  return placeOf;
}

function carried(joint: UrdfJoint, number: number | undefined, placeOf: (link: string) => Place, locked: ReadonlyMap<string, number>): Place {
  if (number !== undefined) return { joint: number, place: new Matrix4() };
  const { joint: carrier, place } = placeOf(joint.parent);
  return { joint: carrier, place: place.clone().multiply(joint.origin).multiply(moved(joint, locked.get(joint.name) ?? 0)) };
}

/** Where the root link is: on the base, or on the last joint of a base that floats, which carries the first joint of the URDF. */
function rootOf(joints: ReadonlyMap<string, UrdfJoint>, numbers: ReadonlyMap<string, number>, skeleton: Skeleton): Place {
  const own = [...joints.values()].flatMap(({ name }) => numbers.get(name) ?? []);
  const first = own.find((number) => {
    const { parent } = skeleton.joints[number]!;
    return parent === null || !own.includes(parent);
  });
  return { joint: first === undefined ? null : skeleton.joints[first]!.parent, place: new Matrix4() };
}

function jointOf(element: Element): UrdfJoint {
  return {
    name: element.getAttribute("name") ?? "",
    kind: element.getAttribute("type") ?? "",
    parent: child(element, "parent")?.getAttribute("link") ?? "",
    origin: originOf(element),
    axis: new Vector3(...numbersOf(child(element, "axis"), "xyz", [1, 0, 0])),
  };
}

/** The motion of a joint to a value. */
function moved({ kind, axis }: UrdfJoint, value: number): Matrix4 {
  const direction = axis.clone().normalize();
  if (kind === "prismatic") return new Matrix4().makeTranslation(direction.multiplyScalar(value));
  if (kind === "revolute" || kind === "continuous") return new Matrix4().makeRotationAxis(direction, value);
  return new Matrix4();
}

function originOf(element: Element): Matrix4 {
  const origin = child(element, "origin");
  const [roll, pitch, yaw] = numbersOf(origin, "rpy", [0, 0, 0]);
  // About the fixed x, y and z axes, one after another.
  const rotation = new Quaternion().setFromEuler(new Euler(roll, pitch, yaw, "ZYX"));
  return new Matrix4().compose(new Vector3(...numbersOf(origin, "xyz", [0, 0, 0])), rotation, new Vector3(1, 1, 1));
}

function shapeOf(visual: Element): Shape | null {
  const shape = child(visual, "geometry")?.firstElementChild;
  if (!shape) return null;
  const number = (name: string) => Number(shape.getAttribute(name) ?? 0) || 0;
  switch (shape.tagName) {
    case "mesh": return { kind: "mesh", file: shape.getAttribute("filename") ?? "", scale: numbersOf(shape, "scale", [1, 1, 1]) };
    case "box": return { kind: "box", size: numbersOf(shape, "size", [0, 0, 0]) };
    case "cylinder": return { kind: "cylinder", radius: number("radius"), length: number("length") };
    case "sphere": return { kind: "sphere", radius: number("radius") };
    default: return null;
  }
}

/** Three numbers of an attribute. */
function numbersOf(element: Element | undefined | null, name: string, otherwise: [number, number, number]): [number, number, number] {
  const numbers = element?.getAttribute(name)?.trim().split(/\s+/).map(Number) ?? [];
  return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as [number, number, number]) : otherwise;
}

function children(element: Element, name: string): Element[] {
  return [...element.children].filter((one) => one.tagName === name);
}

function child(element: Element, name: string): Element | undefined {
  return children(element, name)[0];
}
