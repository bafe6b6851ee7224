// The colours of values from 0 to 1: grey, orange, red, darker as they grow.

/** Red, green and blue from 0 to 1, as the page has them. */
export type Rgb = [number, number, number];

const STOPS: [Rgb, Rgb, Rgb] = [[0.74, 0.79, 0.83], [0.94, 0.6, 0.16], [0.68, 0.06, 0.11]];

export function colourAt(value: number): Rgb {
  const place = 2 * Math.max(0, Math.min(1, value));
  const [from, to] = place < 1 ? [STOPS[0], STOPS[1]] : [STOPS[1], STOPS[2]];
  const part = place < 1 ? place : place - 1;
  return [0, 1, 2].map((k) => from[k]! + part * (to[k]! - from[k]!)) as Rgb;
}

/** The same for styles. */
export function styleAt(value: number): string {
  return `rgb(${colourAt(value).map((part) => Math.round(255 * part)).join(" ")})`;
}

/** All of them from left to right. */
export const SCALE = `linear-gradient(to right, ${[0, 0.5, 1].map(styleAt).join(", ")})`;
