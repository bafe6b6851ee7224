// The body of a link as an ellipsoid: a-priori ones as wires, identified ones filled.

import { Group, LineSegments, Matrix4, Mesh, SphereGeometry, Vector3, WireframeGeometry } from "three";
import type { Ellipsoid } from "../contract";
import type { Materials } from "./materials";

export type BodyLook = "aPriori" | "identified";

const SOLID = new SphereGeometry(1, 24, 16);
const WIRE = new WireframeGeometry(new SphereGeometry(1, 12, 8));
/** The least radius that is drawn, parts of the largest. */
const THINNEST = 1e-3;

export function bodyOf({ centre, radii, axes }: Ellipsoid, look: BodyLook, materials: Materials): Group {
  const part = look === "aPriori" ? new LineSegments(WIRE, materials.aPriori) : new Mesh(SOLID, materials.identified);
  const [x, y, z] = axes.map((axis) => new Vector3(...axis)) as [Vector3, Vector3, Vector3];
  // A mirrored ellipsoid is the same one, and has its outside outside.
  if (x.clone().cross(y).dot(z) < 0) z.negate();
  part.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(x, y, z));
  part.position.set(...centre);
  const largest = Math.max(...radii);
  part.scale.set(...(radii.map((radius) => Math.max(radius, THINNEST * largest, 1e-9)) as [number, number, number]));
  return new Group().add(part);
}
