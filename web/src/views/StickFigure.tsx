// The robot as a stick figure that moves as it was recorded; drag or the slider turns it.

import type { ComponentChildren } from "preact";
import { useMemo, useRef, useState } from "preact/hooks";
import type { Point, Skeleton } from "../contract";
import { useCursor, type Cursor } from "../cursor";
import { ballAround, pathOf, project, upright, type Ball, type Direction } from "../projection";

/** Half the picture's side, in its own units. */
const HALF = 100;
/** The radius of what is drawn, in the same units. */
const SCALE = 92;
const START: Direction = { yaw: -0.6, pitch: 0.35 };
/** Turn per pixel of a drag, rad. */
const TURN = 0.01;

export function StickFigure({ skeleton: recorded, cursor, children }: { skeleton: Skeleton; cursor: Cursor; children: ComponentChildren }) {
  const skeleton = useMemo(() => ({ ...recorded, frames: upright(recorded.frames, recorded.gravity) }), [recorded]);
  const [direction, setDirection] = useState(START);
  useCursor(cursor);
  const ball = useMemo(() => ballAround(skeleton.frames.flat()), [skeleton]);
  const degrees = Math.round((direction.yaw * 180) / Math.PI);
  return (
    <figure class="robot">
      <Picture skeleton={skeleton} index={cursor.index} ball={ball} direction={direction} turn={setDirection} />
      <figcaption class="caption"><span>{cursor.moves ? `The recorded motion, at ${cursor.time.toFixed(2)} s` : "The robot with its joints at zero"}</span></figcaption>
      <div class="controls">
        <TimeControls cursor={cursor} />
        <label>Turn<input type="range" min="-180" max="180" value={degrees} aria-valuetext={`${degrees} degrees`}
          onInput={(event) => setDirection({ ...direction, yaw: (event.currentTarget.valueAsNumber * Math.PI) / 180 })} /></label>
        {children}
      </div>
    </figure>
  );
}

/** Plays, and seeks a time; nothing for a robot that does not move. */
export function TimeControls({ cursor }: { cursor: Cursor }) {
  useCursor(cursor);
  if (!cursor.moves) return null;
  return (
    <>
      <button type="button" onClick={() => (cursor.isPlaying ? cursor.pause() : cursor.play())}>{cursor.isPlaying ? "Pause" : "Play"}</button>
      <label>Time<input type="range" min="0" max={cursor.times.length - 1} value={cursor.index} aria-valuetext={`${cursor.time.toFixed(2)} s`}
        onInput={(event) => cursor.seek(event.currentTarget.valueAsNumber)} /></label>
    </>
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
