// The robot as a stick figure that moves as it was recorded; drag or the slider turns it.

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Point, Skeleton } from "../contract";
import { ballAround, pathOf, project, upright, type Ball, type Direction } from "../projection";

/** Half the picture's side, in its own units. */
const HALF = 100;
/** The radius of what is drawn, in the same units. */
const SCALE = 92;
const START: Direction = { yaw: -0.6, pitch: 0.35 };
/** Turn per pixel of a drag, rad. */
const TURN = 0.01;

export function StickFigure({ skeleton: recorded }: { skeleton: Skeleton }) {
  const skeleton = useMemo(() => ({ ...recorded, frames: upright(recorded.frames, recorded.gravity) }), [recorded]);
  const [direction, setDirection] = useState(START);
  const { index, seek, isPlaying, setPlaying } = usePlayback(skeleton.time_s);
  const ball = useMemo(() => ballAround(skeleton.frames.flat()), [skeleton]);
  const time = skeleton.time_s[index] ?? 0;
  const isMoving = skeleton.frames.length > 1;
  const degrees = Math.round((direction.yaw * 180) / Math.PI);
  return (
    <figure class="robot">
      <Picture skeleton={skeleton} index={index} ball={ball} direction={direction} turn={setDirection} />
      <figcaption class="caption"><span>{isMoving ? `The recorded motion, at ${time.toFixed(2)} s` : "The robot with its joints at zero"}</span></figcaption>
      <div class="controls">
        {isMoving && <button type="button" onClick={() => setPlaying(!isPlaying)}>{isPlaying ? "Pause" : "Play"}</button>}
        {isMoving && <label>Time<input type="range" min="0" max={skeleton.frames.length - 1} value={index} aria-valuetext={`${time.toFixed(2)} s`}
          onInput={(event) => seek(event.currentTarget.valueAsNumber)} /></label>}
        <label>Turn<input type="range" min="-180" max="180" value={degrees} aria-valuetext={`${degrees} degrees`}
          onInput={(event) => setDirection({ ...direction, yaw: (event.currentTarget.valueAsNumber * Math.PI) / 180 })} /></label>
      </div>
    </figure>
  );
}

interface PictureProps {
  skeleton: Skeleton;
  index: number;
  ball: Ball;
  direction: Direction;
  turn: (direction: Direction) => void;
}

function Picture({ skeleton, index, ball, direction, turn }: PictureProps) {
  const place = (point: Point) => project(point, ball, direction);
  const frame = skeleton.frames[index] ?? [];
  const links = linksOf(skeleton, frame).map((ends) => pathOf(ends.map(place), SCALE)).join("");
  const joints = frame.map((point) => pathOf([place(point), place(point)], SCALE)).join("");
  const trace = useMemo(() => pathOf(skeleton.frames.map((points) => place(points.at(-1)!)), SCALE), [skeleton, ball, direction]);
  return (
    <svg class="panel stick" viewBox={`${-HALF} ${-HALF} ${2 * HALF} ${2 * HALF}`} role="img" aria-label="The robot as a stick figure" {...useDrag(direction, turn)}>
      <path class="tool" d={trace} />
      <path class="base" d={pathOf([place([0, 0, 0]), place([0, 0, 0])], SCALE)} />
      <path class="link" d={links} />
      <path class="joint" d={joints} />
    </svg>
  );
}

/** The ends of each link: from the joint before, or the base, to the joint. */
function linksOf({ joints }: Skeleton, frame: Point[]): [Point, Point][] {
  const base: Point = [0, 0, 0];
  return joints.map(({ parent }, joint) => [parent === null ? base : frame[parent]!, frame[joint]!]);
}

/** Drags turn the picture: sideways about the vertical, up and down against the horizon. */
function useDrag({ yaw, pitch }: Direction, turn: (direction: Direction) => void) {
  const isDown = useRef(false);
  return {
    onPointerDown: (event: PointerEvent) => {
      isDown.current = true;
      (event.currentTarget as Element).setPointerCapture(event.pointerId);
    },
    onPointerMove: (event: PointerEvent) => {
      if (!isDown.current) return;
      const limit = Math.PI / 2;
      turn({ yaw: wrapped(yaw - event.movementX * TURN), pitch: Math.max(-limit, Math.min(limit, pitch + event.movementY * TURN)) });
    },
    onPointerUp: () => { isDown.current = false; },
    onPointerCancel: () => { isDown.current = false; },
  };
}

function wrapped(angle: number): number {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}

/** Plays the moments at their times, over and over; starts by itself where motion is welcome. */
function usePlayback(times: number[]) {
  const [index, setIndex] = useState(0);
  const [isPlaying, setPlaying] = useState(() => !matchMedia("(prefers-reduced-motion: reduce)").matches);
  useEffect(() => {
    if (!isPlaying || times.length < 2) return;
    const begin = performance.now() - 1000 * ((times[index] ?? 0) - times[0]!);
    let request = requestAnimationFrame(function step(now) {
      setIndex(indexAt(times, (now - begin) / 1000));
      request = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(request);
  }, [isPlaying, times]);
  const seek = (to: number) => { setPlaying(false); setIndex(to); };
  return { index: Math.min(index, times.length - 1), seek, isPlaying, setPlaying };
}

/** The last moment up to a time since the first, which begins again after the last. */
function indexAt(times: number[], elapsed: number): number {
  const [first, last] = [times[0]!, times.at(-1)!];
  const time = first + (elapsed % Math.max(last - first, 1e-3));
  const after = times.findIndex((moment) => moment > time);
  return after < 0 ? times.length - 1 : Math.max(0, after - 1);
}
