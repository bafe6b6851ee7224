// What was read from the files, and the choices that correct it.

import { useEffect, useMemo, useState } from "preact/hooks";
import type { RecordingAnswer, RobotAnswer, Understanding } from "../contract";
import { Cursor } from "../cursor";
import { count, seconds, significant } from "../words";
import { Choices } from "./Choices";
import { Findings } from "./Findings";
import type { View } from "./Page";
import { RecordPlot } from "./RecordPlot";
import { Robot3D, webGlRenderer } from "./Robot3D";
import { StickFigure } from "./StickFigure";

export function Understood({ state, app, understanding }: View & { understanding: Understanding }) {
  const { robot, recordings, proposal, skeleton, series } = understanding;
  const cursor = useMoment(understanding);
  const [isSpatial, setSpatial] = useState(false);
  const isDrawn = skeleton !== null && skeleton.frames.length > 0;
  return (
    <section id="understood" aria-labelledby="understood-title" aria-busy={state.task?.name === "understand"}>
      <h2 id="understood-title">What we read</h2>
      <div class="head">
        <div>
          <dl>
            {robot && <Robot robot={robot} />}
            {recordings.map((recording) => <Recording key={recording.path} recording={recording} />)}
            {proposal && <Proposal understanding={understanding} />}
          </dl>
          <Findings state={state} app={app} understanding={understanding} problem={state.problem?.at === "understand" ? state.problem.message : null} />
        </div>
        {isDrawn && !isSpatial && <StickFigure skeleton={skeleton} cursor={cursor}><Opener open={() => setSpatial(true)} /></StickFigure>}
      </div>
      {isDrawn && isSpatial && <Robot3D key={skeleton} skeleton={skeleton} series={series} cursor={cursor} state={state} app={app} close={() => setSpatial(false)} />}
      {series && <RecordPlot series={series} cursor={cursor} state={state} app={app} />}
      {recordings.length > 0 && robot && <Choices state={state} app={app} understanding={understanding} />}
      {recordings.map((recording) => <Inspected key={recording.path} recording={recording} />)}
    </section>
  );
}

/** The moment that all drawings of an understanding show; it plays by itself where motion is welcome. */
function useMoment({ skeleton }: Understanding): Cursor {
  const cursor = useMemo(() => new Cursor(skeleton?.time_s ?? []), [skeleton]);
  useEffect(() => {
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) cursor.play();
    return () => cursor.pause();
  }, [cursor]);
  return cursor;
}

/** Opens the drawing in space, where the browser has one. */
function Opener({ open }: { open: () => void }) {
  const renderer = useMemo(webGlRenderer, []);
  if (renderer === null) return <p class="note">This browser has no WebGL, so there is no drawing in 3D.</p>;
  return <button type="button" onClick={open}>Show in 3D</button>;
}

function Robot({ robot }: { robot: RobotAnswer }) {
  const joints = robot.joints.map((joint) => joint.name).join(", ");
  return <><dt>Robot</dt><dd>{robot.name}: {count(robot.joints.length, "joint")}: {joints}</dd></>;
}

function Recording({ recording }: { recording: RecordingAnswer }) {
  const rate = recording.rate_hz === null ? "" : ` at ${significant(recording.rate_hz)} Hz`;
  return <><dt>Log</dt><dd>{recording.path}: {recording.format}, {count(recording.samples, "sample")}{rate}</dd></>;
}

function Proposal({ understanding }: { understanding: Understanding }) {
  const { window_s: window, position, torque, locked } = understanding.proposal!;
  const unit = (value: string | string[]) => [...new Set([value].flat())].join(", ");
  return (
    <>
      <dt>Positions</dt><dd>{unit(position.unit)}, at the {position.side}s</dd>
      <dt>Torques</dt><dd>{unit(torque.unit)}, at the {torque.side}s</dd>
      <dt>Window</dt><dd>{seconds(window[0])} to {seconds(window[1])}</dd>
      {locked.length > 0 && <><dt>Locked</dt><dd>{locked.map(({ name, value }) => `${name} at ${significant(value)}`).join(", ")}</dd></>}
    </>
  );
}

/** The lines of `thetahat inspect`. */
function Inspected({ recording }: { recording: RecordingAnswer }) {
  return (
    <details>
      <summary>Columns of {recording.path}</summary>
      <pre tabIndex={0} role="region" aria-label={`Columns of ${recording.path}`}>{recording.text}</pre>
    </details>
  );
}
