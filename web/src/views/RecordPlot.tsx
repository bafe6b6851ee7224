// Positions and torques of each joint, with the window used: dragged, or typed.

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { App } from "../app";
import type { Residual, Series } from "../contract";
import { useCursor, type Cursor } from "../cursor";
import { panelOf, timeTicks, type Panel } from "../panel";
import { isAtWork, isOwnText, type State } from "../state";
import { seconds, significant } from "../words";

type Window = [number, number];

const WIDTH = 340;
const PLOT = { left: 46, width: 286, top: 24, height: 62, gap: 14 };

export function RecordPlot({ series, cursor, state, app }: { series: Series; cursor: Cursor; state: State; app: App }) {
  const [dragged, setDragged] = useState<Window | null>(null);
  const window = dragged ?? series.window_s;
  const isFixed = isOwnText(state.experiment);
  const residual = state.identified?.residual ?? null;
  useEffect(() => setDragged(null), [series]);
  const choose = (chosen: Window) => {
    setDragged(chosen);
    void app.choose({ window_s: chosen });
  };
  return (
    <figure class="record">
      <figcaption class="caption"><span>Positions and torques{residual && `, and what ${residual.method.toUpperCase()} leaves of the torques`}; the window used is shaded</span></figcaption>
      {!isFixed && <WindowFields series={series} window={window} isBusy={isAtWork(state)} choose={choose} asFound={() => app.choose({ window_s: undefined })} />}
      <div class="charts">
        {series.joints.map((name, joint) => (
          <Chart key={name} series={series} joint={joint} residual={residualOf(state, name)} cursor={cursor} window={window} drag={isFixed || isAtWork(state) ? null : setDragged} drop={choose} />
        ))}
      </div>
    </figure>
  );
}

/** The residual of a joint, by its name. */
export function residualOf({ identified }: State, name: string): JointResidual | null {
  const joint = identified?.results.robot_joints.findIndex((one) => one.name === name) ?? -1;
  const residual = identified?.residual;
  const values = residual?.residual[joint];
  return residual && values ? { time_s: residual.time_s, values, noise: residual.noise[joint] ?? 0 } : null;
}

export interface JointResidual {
  time_s: Residual["time_s"];
  values: number[];
  noise: number;
}

interface FieldsProps {
  series: Series;
  window: Window;
  isBusy: boolean;
  choose: (window: Window) => void;
  asFound: () => void;
}

function WindowFields({ series, window, isBusy, choose, asFound }: FieldsProps) {
  const [first, last] = endsOf(series);
  const step = stepOf(last - first);
  const field = (label: string, value: number, change: (value: number) => Window) => (
    <label>{label}
      <input type="number" aria-label={`Window ${label}, s`} min={first} max={last} step={step} value={Number(value.toFixed(4))}
        onChange={(event) => choose(ordered(change(event.currentTarget.valueAsNumber || 0), series))} />
      <span aria-hidden="true">s</span>
    </label>
  );
  return (
    <fieldset class="fields window" disabled={isBusy}>
      <legend class="unseen">Window</legend>
      <span aria-hidden="true">Window</span>
      {field("from", window[0], (value) => [value, window[1]])}
      {field("to", window[1], (value) => [window[0], value])}
      <button type="button" onClick={() => choose([first, last])}>Whole recording</button>
      <button type="button" onClick={asFound}>As detected</button>
    </fieldset>
  );
}

/** A step of the fields: about a hundredth of the recording, in round numbers. */
function stepOf(length: number): number {
  return 10 ** Math.floor(Math.log10(Math.max(length, 1e-3) / 50));
}

function endsOf({ time_s: times }: Series): Window {
  return [times[0] ?? 0, times.at(-1) ?? 0];
}

/** A window inside the recording that does not end before it begins. */
function ordered([a, b]: Window, series: Series): Window {
  const [first, last] = endsOf(series);
  const inside = (value: number) => Math.max(first, Math.min(last, Number(value.toFixed(4))));
  return [inside(Math.min(a, b)), inside(Math.max(a, b))];
}

interface ChartProps {
  series: Series;
  joint: number;
  residual: JointResidual | null;
  cursor: Cursor;
  window: Window;
  drag: ((window: Window | null) => void) | null;
  drop: (window: Window) => void;
}

function Chart({ series, joint, residual, cursor, window, drag, drop }: ChartProps) {
  const ends = endsOf(series);
  const [position, torque] = useMemo(() => [
    panelOf(series.time_s, series.position[joint] ?? [], PLOT),
    panelOf(series.time_s, series.torque[joint] ?? [], PLOT),
  ], [series, joint]);
  const x = (time: number) => PLOT.left + (PLOT.width * (time - ends[0])) / Math.max(ends[1] - ends[0], 1e-9);
  const second = PLOT.top + PLOT.height + PLOT.gap;
  const third = second + PLOT.height + PLOT.gap;
  const bottom = (residual ? third : second) + PLOT.height;
  const left = useMemo(() => residual && panelOf(residual.time_s, residual.values, PLOT, ends), [series, residual?.values]);
  const name = series.joints[joint];
  return (
    <svg class={`chart ${drag ? "drags" : ""}`} viewBox={`0 0 ${WIDTH} ${bottom + 22}`} role="img"
      aria-label={`${name}: position${residual ? ", torque and residual" : " and torque"} over time; the window is ${seconds(window[0])} to ${seconds(window[1])}`}
      {...useWindowDrag(series, window, drag, drop)}>
      <text class="title" x="2" y="13">{name}</text>
      <rect class="window" x={x(window[0])} y={PLOT.top} width={Math.max(0, x(window[1]) - x(window[0]))} height={bottom - PLOT.top} />
      <Curve panel={position!} top={PLOT.top} unit={unitOf(series.position_unit, joint)} curve="position" />
      <Curve panel={torque!} top={second} unit={unitOf(series.torque_unit, joint)} curve="torque" />
      {left && <Curve panel={left} top={third} unit={unitOf(series.torque_unit, joint)} curve="residual" />}
      <path class="edge" d={window.map((time) => `M${x(time)} ${PLOT.top}V${bottom}`).join("")} />
      <path class="axis" d={`M${PLOT.left} ${bottom}h${PLOT.width}`} />
      {cursor.moves && <CursorLine cursor={cursor} x={x} top={PLOT.top} bottom={bottom} />}
      {timeTicks(ends).map((tick) => <text key={tick} x={x(tick)} y={bottom + 14} text-anchor="middle">{significant(tick)}</text>)}
    </svg>
  );
}

/** The moment that the robot shows. */
function CursorLine({ cursor, x, top, bottom }: { cursor: Cursor; x: (time: number) => number; top: number; bottom: number }) {
  useCursor(cursor);
  return <path class="moment" d={`M${x(cursor.time).toFixed(1)} ${top}V${bottom}`} />;
}

/** The unit of a joint's values: one for all, or one of each. */
export function unitOf(unit: string | string[], joint: number): string {
  return typeof unit === "string" ? unit : (unit[joint] ?? "");
}

function Curve({ panel, top, unit, curve }: { panel: Panel; top: number; unit: string; curve: string }) {
  const [low, high] = panel.range;
  return (
    <>
      <path class="grid" d={`M${PLOT.left} ${top}h${PLOT.width}m0 ${PLOT.height}h${-PLOT.width}`} />
      <text x={PLOT.left - 5} y={top + 9} text-anchor="end">{significant(high, 3)}</text>
      <text x={PLOT.left - 5} y={top + PLOT.height / 2 + 3.5} text-anchor="end">{unit}</text>
      <text x={PLOT.left - 5} y={top + PLOT.height} text-anchor="end">{significant(low, 3)}</text>
      <path class={`curve ${curve}`} transform={`translate(${PLOT.left} ${top})`} d={panel.path} />
    </>
  );
}

/** Near an edge a drag moves that edge; elsewhere it draws a new window. */
function useWindowDrag(series: Series, window: Window, drag: ChartProps["drag"], drop: ChartProps["drop"]) {
  const fixed = useRef<number | null>(null);
  if (!drag) return {};
  const [first, last] = endsOf(series);
  const near = (last - first) / 30;
  return {
    onPointerDown: (event: PointerEvent) => {
      const time = timeAt(event, first, last);
      const [from, to] = window;
      fixed.current = Math.abs(time - from) < near ? to : Math.abs(time - to) < near ? from : time;
      (event.currentTarget as Element).setPointerCapture(event.pointerId);
    },
    onPointerMove: (event: PointerEvent) => {
      if (fixed.current !== null) drag(ordered([fixed.current, timeAt(event, first, last)], series));
    },
    onPointerUp: (event: PointerEvent) => {
      if (fixed.current === null) return;
      const chosen = ordered([fixed.current, timeAt(event, first, last)], series);
      fixed.current = null;
      if (chosen[1] - chosen[0] > near / 3) drop(chosen);
      else drag(null);
    },
    onPointerCancel: () => { fixed.current = null; drag(null); },
  };
}

function timeAt(event: PointerEvent, first: number, last: number): number {
  const box = (event.currentTarget as Element).getBoundingClientRect();
  const x = ((event.clientX - box.left) / box.width) * WIDTH;
  return first + ((x - PLOT.left) / PLOT.width) * (last - first);
}
