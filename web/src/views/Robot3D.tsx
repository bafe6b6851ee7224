// The robot in 3D at the moment of the cursor, with the values of its joints.

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { App } from "../app";
import type { LinkBody, Series, Skeleton } from "../contract";
import { lastUpTo, useCursor, type Cursor } from "../cursor";
import { loadScene } from "../program";
import { SCALE, styleAt } from "../scene/colours";
import type { Described } from "../scene/meshes";
import type { Scene, Shown } from "../scene/scene";
import type { State } from "../state";
import { count, significant } from "../words";
import { residualOf, unitOf, type JointResidual } from "./RecordPlot";
import { TimeControls } from "./StickFigure";

/** What colours a joint. */
type Paint = "none" | "torque" | "residual";

/** The residual that has the last colour, in root mean squares of its joint. */
const LARGEST_RESIDUAL = 3;
/** Turn of a key, rad, and the factor by which it comes nearer. */
const KEY = { turn: 0.1, zoom: 0.9 };

/** Names of renderers that compute on the processor. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** What draws WebGL; null where nothing does. */
export function webGlRenderer(): string | null {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return null;
  const named = context.getExtension("WEBGL_debug_renderer_info");
  const name = String(context.getParameter(named?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER));
  // Browsers have few contexts.
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}

interface Props {
  skeleton: Skeleton;
  series: Series | null;
  cursor: Cursor;
  state: State;
  app: App;
  close: () => void;
}

export function Robot3D({ skeleton, series, cursor, state, app, close }: Props) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const { scene, failure } = useScene(canvas, skeleton);
  const joints = useMemo(() => jointsOf(skeleton, series, state), [skeleton, series, state.identified]);
  const [paint, setPaint] = useState<Paint>("torque");
  const [shown, setShown] = useState<Shown>({ meshes: true, aPriori: true, identified: true });
  const described = useMeshes(scene, state, app);
  const bodies = useBodies(scene, state, app);
  const hasResidual = joints.some(({ residual }) => residual);
  const hasTorque = joints.some(({ curves }) => curves?.largest);
  const painted: Paint = !hasTorque || (paint === "residual" && !hasResidual) ? "none" : paint;
  useEffect(() => scene?.reveal(shown), [scene, shown]);
  useEffect(() => {
    if (!scene) return;
    const follow = () => {
      scene.show(cursor.index);
      scene.paint(joints.map((joint) => valueOf(joint, painted, cursor.time)));
    };
    follow();
    return cursor.subscribe(follow);
  }, [scene, cursor, joints, painted]);
  const toggle = (part: keyof Shown, label: string) => (
    <label class="key"><input type="checkbox" checked={shown[part]} onChange={(event) => setShown({ ...shown, [part]: event.currentTarget.checked })} />{label}</label>
  );
  return (
    <figure class="space" aria-busy={scene === null && failure === null}>
      <figcaption class="caption"><span>The robot in 3D</span><button type="button" onClick={close}>Show flat</button></figcaption>
      {failure && <p class="error" role="alert">The drawing in 3D failed: {failure}</p>}
      <div class="stage">
        <canvas ref={canvas} tabIndex={0} role="application" aria-label="The robot in 3D: drag or arrow keys turn it, plus and minus zoom"
          onKeyDown={(event) => scene && onKey(scene, event)} onFocus={() => scene?.setZoom(true)} onBlur={() => scene?.setZoom(false)} />
        <div class="aside">
          <div class="controls">
            <TimeControls cursor={cursor} />
            {hasTorque && <label>Colour<select value={painted} onChange={(event) => setPaint(event.currentTarget.value as Paint)}>
              <option value="none">none</option>
              <option value="torque">torque</option>
              {hasResidual && <option value="residual">residual</option>}
            </select></label>}
          </div>
          <Legend paint={painted} />
          <div class="parts" role="group" aria-label="Shown parts">
            {described && described.links.size > 0 && toggle("meshes", "Meshes")}
            {skeleton.bodies.some(({ body }) => body) && toggle("aPriori", "Inertia a priori, as wires")}
            {bodies.length > 0 && toggle("identified", `Inertia identified${state.identified?.results.verdict === "do-not-use" ? " (do not use)" : ""}, filled`)}
          </div>
          <Values joints={joints} cursor={cursor} paint={painted} />
        </div>
      </div>
      {described ? <Missing described={described} /> : state.files.some(({ kind }) => kind === "mesh") && <p class="note">Reading the meshes.</p>}
    </figure>
  );
}

/** The scene of a canvas, as large as its place; it ends with the view. */
function useScene(canvas: { current: HTMLCanvasElement | null }, skeleton: Skeleton) {
  const [scene, setScene] = useState<Scene | null>(null);
  const [failure, setFailure] = useState<string | null>(null);
  useEffect(() => {
    let opened: Scene | null = null;
    let isGone = false;
    const element = canvas.current!;
    const size = new ResizeObserver(() => opened?.resize(element.clientWidth, element.clientHeight));
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const restyle = () => opened?.restyle();
    loadScene().then(({ Scene }) => {
      if (isGone) return;
      opened = new Scene(element, skeleton, SOFTWARE.test(webGlRenderer() ?? ""));
      size.observe(element);
      dark.addEventListener("change", restyle);
      setScene(opened);
    }).catch((error) => setFailure(error instanceof Error ? error.message : String(error)));
    return () => {
      isGone = true;
      size.disconnect();
      dark.removeEventListener("change", restyle);
      opened?.close();
    };
  }, [skeleton]);
  return { scene, failure };
}

const NOTHING: Described = { files: 0, triangles: 0, links: new Set(), missing: [], unreadable: [] };

/** Draws the meshes of the robot once they are read; null until then. */
function useMeshes(scene: Scene | null, state: State, app: App): Described | null {
  const [described, setDescribed] = useState<Described | null>(null);
  const names = state.files.filter(({ kind }) => kind === "mesh").map(({ path }) => path).join();
  useEffect(() => {
    if (!scene) return;
    const locked = new Map(state.understanding?.proposal?.locked.map(({ name, value }) => [name, value]));
    const read = async () => {
      const { path, text: urdf } = await app.urdf();
      setDescribed(urdf === "" ? NOTHING : await scene.describe({ urdf, path, files: app.meshes, locked }));
    };
    // The session ends if the person cancels its work: the boxes stay.
    void read().catch(() => setDescribed(NOTHING));
  }, [scene, names]);
  return described;
}

/** Draws the bodies of the result. */
function useBodies(scene: Scene | null, { identified }: State, app: App): LinkBody[] {
  const [bodies, setBodies] = useState<LinkBody[]>([]);
  useEffect(() => {
    setBodies([]);
    scene?.identify([]);
    if (!scene || !identified) return;
    let isGone = false;
    // Without a consistent robot there are none.
    void app.bodies(identified).catch(() => []).then((found) => {
      if (isGone) return;
      setBodies(found.filter(({ body }) => body));
      scene.identify(found);
    });
    return () => { isGone = true; };
  }, [scene, identified]);
  return bodies;
}

function onKey(scene: Scene, event: KeyboardEvent): void {
  const acts: Record<string, () => void> = {
    ArrowLeft: () => scene.turn(-KEY.turn, 0),
    ArrowRight: () => scene.turn(KEY.turn, 0),
    ArrowUp: () => scene.turn(0, KEY.turn),
    ArrowDown: () => scene.turn(0, -KEY.turn),
    "+": () => scene.zoom(KEY.zoom),
    "=": () => scene.zoom(KEY.zoom),
    "-": () => scene.zoom(1 / KEY.zoom),
  };
  const act = acts[event.key];
  if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  act();
}

/** The curves of a joint of the skeleton. */
interface JointCurves {
  name: string;
  /** Null without a coordinate in the recording. */
  curves: { time_s: number[]; position: number[]; torque: number[]; largest: number; positionUnit: string; torqueUnit: string } | null;
  residual: JointResidual | null;
}

function jointsOf({ joints }: Skeleton, series: Series | null, state: State): JointCurves[] {
  return joints.map(({ name }) => {
    const number = series?.joints.indexOf(name) ?? -1;
    if (!series || number < 0) return { name, curves: null, residual: null };
    const torque = series.torque[number] ?? [];
    const curves = {
      time_s: series.time_s,
      position: series.position[number] ?? [],
      torque,
      largest: torque.reduce((largest, value) => Math.max(largest, Math.abs(value)), 0),
      positionUnit: unitOf(series.position_unit, number),
      torqueUnit: unitOf(series.torque_unit, number),
    };
    return { name, curves, residual: residualOf(state, name) };
  });
}

/** The value of a joint's colour, from 0 to 1; null is without one. */
function valueOf({ curves, residual }: JointCurves, paint: Paint, time: number): number | null {
  switch (paint) {
    case "none": return null;
    case "torque": {
      const torque = curves && at(curves.time_s, curves.torque, time);
      return torque === null || !curves?.largest ? null : Math.abs(torque) / curves.largest;
    }
    case "residual": {
      const left = residual && at(residual.time_s, residual.values, time);
      return left === null || !residual?.noise ? null : Math.abs(left) / (LARGEST_RESIDUAL * residual.noise);
    }
  }
}

/** The value of a curve at a time; null outside. */
function at(times: number[], values: number[], time: number): number | null {
  const [first, last] = [times[0] ?? 0, times.at(-1) ?? 0];
  // A moment of the skeleton may be a step of the curve after its last.
  const step = (last - first) / Math.max(times.length - 1, 1);
  if (time < first - step || time > last + step) return null;
  return values[lastUpTo(times, time)] ?? null;
}

function Legend({ paint }: { paint: Paint }) {
  if (paint === "none") return null;
  const [least, most] = paint === "torque" ? ["no torque", "the joint's largest"] : ["no residual", `${LARGEST_RESIDUAL} times its root mean square`];
  return (
    <p class="legend"><span>{least}</span><span class="colours" style={{ background: SCALE }} /><span>{most}</span></p>
  );
}

/** The values of all joints at the moment. */
function Values({ joints, cursor, paint }: { joints: JointCurves[]; cursor: Cursor; paint: Paint }) {
  useCursor(cursor);
  const known = joints.filter(({ curves }) => curves);
  if (known.length === 0) return null;
  const hasResidual = known.some(({ residual }) => residual);
  const cell = (value: number | null, unit: string) => <td>{value === null ? "" : `${significant(value, 3)} ${unit}`}</td>;
  return (
    <div class="scroll" tabIndex={0} role="region" aria-label="Values of the joints">
      <table class="now">
        <caption>At {cursor.time.toFixed(2)} s</caption>
        <thead><tr><th class="lead">joint</th><th>position</th><th>torque</th>{hasResidual && <th>residual</th>}</tr></thead>
        <tbody>{known.map((joint) => {
          const value = valueOf(joint, paint, cursor.time);
          return (
            <tr key={joint.name}>
              <th class="lead" scope="row"><span class="swatch" style={{ background: value === null ? "none" : styleAt(value) }} />{joint.name}</th>
              {cell(at(joint.curves!.time_s, joint.curves!.position, cursor.time), joint.curves!.positionUnit)}
              {cell(at(joint.curves!.time_s, joint.curves!.torque, cursor.time), joint.curves!.torqueUnit)}
              {hasResidual && cell(joint.residual && at(joint.residual.time_s, joint.residual.values, cursor.time), joint.curves!.torqueUnit)}
            </tr>
          );
        })}</tbody>
      </table>
    </div>
  );
}

/** Meshes that are not drawn: boxes stand for their links. */
function Missing({ described: { missing, unreadable, files } }: { described: Described }) {
  if (missing.length + unreadable.length === 0) return null;
  return (
    <details class="missing" open={files > 0}>
      <summary>{count(missing.length + unreadable.length, "file")} of meshes not drawn; boxes stand for their links</summary>
      <ul>
        {missing.map((file) => <li key={file}>{file}: drop this file on the page, or its folder</li>)}
        {unreadable.map(({ file, why }) => <li key={file}>{file}: {why}</li>)}
      </ul>
    </details>
  );
}
