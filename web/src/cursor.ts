// The one moment that the robot and all curves show.

import { useEffect, useState } from "preact/hooks";

/** A moment of a recording, which plays at its own speed. */
export class Cursor {
  /** The number of the moment. */
  index = 0;
  isPlaying = false;
  private readonly listeners = new Set<() => void>();
  private request = 0;

  /** The times of the moments, s. */
  constructor(readonly times: number[]) {}

  get time(): number {
    return this.times[this.index] ?? 0;
  }

  get moves(): boolean {
    return this.times.length > 1;
  }

  /** Stops at a moment. */
  seek(index: number): void {
    this.pause();
    this.set(Math.max(0, Math.min(index, this.times.length - 1)));
  }

  /** Plays the moments at their times, over and over. */
  play(): void {
    if (this.isPlaying || !this.moves) return;
    this.isPlaying = true;
    const begin = performance.now() - 1000 * (this.time - this.times[0]!);
    const step = (now: number) => {
      this.set(indexAt(this.times, (now - begin) / 1000));
      this.request = requestAnimationFrame(step);
    };
    this.request = requestAnimationFrame(step);
    this.notify();
  }

  pause(): void {
    if (!this.isPlaying) return;
    cancelAnimationFrame(this.request);
    this.isPlaying = false;
    this.notify();
  }

  /** Calls a listener at each change, until the returned function is called. */
  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  private set(index: number): void {
    if (index === this.index) return;
    this.index = index;
    this.notify();
  }

  private notify(): void {
    for (const listener of this.listeners) listener();
  }
}

/** Draws a view again at each change of the cursor. */
export function useCursor(cursor: Cursor): void {
  const [, draw] = useState(0);
  useEffect(() => cursor.subscribe(() => draw((times) => times + 1)), [cursor]);
}

/** The last moment up to a time since the first, which begins again after the last. */
function indexAt(times: number[], elapsed: number): number {
  const [first, last] = [times[0]!, times.at(-1)!];
  return lastUpTo(times, first + (elapsed % Math.max(last - first, 1e-3)));
}

/** The number of the last of rising times up to a time; the first if there is none. */
export function lastUpTo(times: ArrayLike<number>, time: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= time) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}
