// What was read from the files, and the choices that correct it.

import type { RecordingAnswer, RobotAnswer, Understanding } from "../contract";
import { count, seconds, significant } from "../words";
import { Choices } from "./Choices";
import { Findings } from "./Findings";
import type { View } from "./Page";
import { RecordPlot } from "./RecordPlot";
import { StickFigure } from "./StickFigure";

export function Understood({ state, app, understanding }: View & { understanding: Understanding }) {
  const { robot, recordings, proposal, skeleton, series } = understanding;
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
        {skeleton && skeleton.frames.length > 0 && <StickFigure skeleton={skeleton} />}
      </div>
      {series && <RecordPlot series={series} state={state} app={app} />}
      {recordings.length > 0 && robot && <Choices state={state} app={app} understanding={understanding} />}
      {recordings.map((recording) => <Inspected key={recording.path} recording={recording} />)}
    </section>
  );
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
