// Curves of a small chart.

export interface Panel {
  path: string;
  range: [number, number];
}

/** A curve over the times in a panel of some width and height, from the first to the last of its times or of others. */
export function panelOf(times: number[], values: number[], { width, height }: { width: number; height: number }, ends?: [number, number]): Panel {
  const [first, last] = ends ?? [times[0] ?? 0, times.at(-1) ?? 1];
  const [low, high] = rangeOf(values);
  const x = (time: number) => ((time - first) / Math.max(last - first, 1e-12)) * width;
  const y = (value: number) => (1 - (value - low) / (high - low)) * height;
  const points = values.map((value, index) => `${x(times[index]!).toFixed(1)} ${y(value).toFixed(1)}`);
  return { path: points.length === 0 ? "" : `M${points.join("L")}`, range: [low, high] };
}

/** From the smallest to the largest value, never empty. */
function rangeOf(values: number[]): [number, number] {
  const [low, high] = values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
  if (!(low <= high)) return [0, 1];
  return high > low ? [low, high] : [low - 1, high + 1];
}

/** Round times between two, about five. */
export function timeTicks([first, last]: [number, number]): number[] {
  const rough = Math.max(last - first, 1e-9) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((candidate) => candidate >= rough)!;
  const begin = Math.ceil(first / step - 1e-9);
  const ticks = Math.floor((last - first) / step + 1e-9);
  return Array.from({ length: ticks + 1 }, (_, index) => Number(((begin + index) * step).toPrecision(6))).filter((tick) => tick <= last);
}
