// Surfaces with fewer triangles, where no graphics processor draws them.

import { BufferAttribute, BufferGeometry, Triangle, Vector3 } from "three";

/** A surface whose points in one cell of a grid, on one side of it, are one point; triangles that become lines are left out. */
export function simpler(surface: BufferGeometry, cell: number): BufferGeometry {
  const points = new Points(cell);
  const triangles: number[] = [];
  const [triangle, across] = [new Triangle(), new Vector3()];
  const position = surface.getAttribute("position");
  const corners = surface.index?.count ?? position.count;
  const vertex = (corner: number) => surface.index?.getX(corner) ?? corner;
  for (let corner = 0; corner + 2 < corners; corner += 3) {
    triangle.setFromAttributeAndIndices(position, vertex(corner), vertex(corner + 1), vertex(corner + 2));
    const side = sideOf(triangle.getNormal(across));
    const [a, b, c] = [triangle.a, triangle.b, triangle.c].map((point) => points.numberOf(point, side)) as [number, number, number];
    if (a !== b && b !== c && c !== a) triangles.push(a, b, c);
  }
  const simple = new BufferGeometry().setIndex(triangles).setAttribute("position", new BufferAttribute(new Float32Array(points.places), 3));
  simple.computeVertexNormals();
  return simple;
}

/** Points by their cells and sides. */
class Points {
  readonly places: number[] = [];
  private readonly numbers = new Map<number, number>();

  constructor(private readonly cell: number) {}

  /** The number of the first point of the same cell and side. */
  numberOf({ x, y, z }: Vector3, side: number): number {
    const [a, b, c] = [x, y, z].map((value) => Math.max(0, Math.min(2 * HALF - 1, Math.round(value / this.cell) + HALF))) as [number, number, number];
    const key = ((a * 2 * HALF + b) * 2 * HALF + c) * 6 + side;
    const known = this.numbers.get(key);
    if (known !== undefined) return known;
    const number = this.numbers.size;
    this.numbers.set(key, number);
    this.places.push(x, y, z);
    return number;
  }
}

/** Cells on each side of zero: three such numbers and a side are one whole number without rounding. */
const HALF = 2 ** 15;

/** The axis along which a direction points most, from zero to five: edges between sides stay sharp. */
function sideOf(direction: Vector3): number {
  const parts = direction.toArray();
  const largest = parts.reduce((best, part, axis) => (Math.abs(part) > Math.abs(parts[best]!) ? axis : best), 0);
  return 2 * largest + (parts[largest]! < 0 ? 1 : 0);
}
