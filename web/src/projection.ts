// From points in space to a picture: z up, seen from a direction, without perspective.

import type { Point } from "./contract";

export interface Direction {
  /** About the vertical, rad. */
  yaw: number;
  /** Above the horizon, rad. */
  pitch: number;
}

/** A sphere around everything drawn. */
export interface Ball {
  centre: Point;
  radius: number;
}

/** The axes of an upright frame: z against gravity, x as close to the robot's x axis as possible. */
export function uprightAxes(gravity: Point): [Point, Point, Point] {
  const up = unit([-gravity[0], -gravity[1], -gravity[2]]) ?? [0, 0, 1];
  const level = (axis: Point) => unit([0, 1, 2].map((k) => axis[k]! - dot(axis, up) * up[k]!) as Point);
  const ahead = level([1, 0, 0]) ?? level([0, 1, 0])!;
  const left: Point = [up[1] * ahead[2] - up[2] * ahead[1], up[2] * ahead[0] - up[0] * ahead[2], up[0] * ahead[1] - up[1] * ahead[0]];
  return [ahead, left, up];
}

/** The points in the upright frame. */
export function upright(frames: Point[][], gravity: Point): Point[][] {
  const [ahead, left, up] = uprightAxes(gravity);
  return frames.map((points) => points.map((point) => [dot(point, ahead), dot(point, left), dot(point, up)]));
}

function dot(a: Point, b: Point): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** A vector of length one; null without a direction. */
function unit([x, y, z]: Point): Point | null {
  const length = Math.hypot(x, y, z);
  return length < 1e-6 ? null : [x / length, y / length, z / length];
}

/** The sphere about the middle of the points and of the origin, where the robot stands. */
export function ballAround(points: Point[]): Ball {
  const all: Point[] = [[0, 0, 0], ...points];
  const middle = (axis: 0 | 1 | 2) => {
    const values = all.map((point) => point[axis]);
    return (values.reduce((a, b) => Math.min(a, b)) + values.reduce((a, b) => Math.max(a, b))) / 2;
  };
  const centre: Point = [middle(0), middle(1), middle(2)];
  const distance = ([x, y, z]: Point) => Math.hypot(x - centre[0], y - centre[1], z - centre[2]);
  return { centre, radius: all.map(distance).reduce((a, b) => Math.max(a, b), 1e-9) };
}

/** The position of a point in a picture centred on the ball with its radius as half height. */
export function project([x, y, z]: Point, { centre, radius }: Ball, { yaw, pitch }: Direction): [number, number] {
  const [a, b, c] = [x - centre[0], y - centre[1], z - centre[2]];
  const right = a * Math.cos(yaw) + b * Math.sin(yaw);
  const depth = b * Math.cos(yaw) - a * Math.sin(yaw);
  const up = c * Math.cos(pitch) + depth * Math.sin(pitch);
  return [right / radius, -up / radius];
}

/** A path through points of a picture. */
export function pathOf(points: [number, number][], scale: number): string {
  return points.map(([x, y], index) => `${index === 0 ? "M" : "L"}${(x * scale).toFixed(1)} ${(y * scale).toFixed(1)}`).join("");
}
