// The user's corrections: unit, side, columns of each joint, joints that do not move.

import { useEffect, useRef, useState } from "preact/hooks";
import type { App } from "../app";
import { assignmentOf, choicesOf, columnNames, type Assignment, type JointColumns } from "../columns";
import type { ProposalAnswer, Side, Understanding } from "../contract";
import { isAtWork, isOwnText, type State } from "../state";
import { Estimation } from "./Estimation";

const POSITION_UNITS = ["rad", "mrad", "deg", "rev", "m", "mm", "um"];
const TORQUE_UNITS = ["N m", "mN m", "kN m", "N", "kN", "A", "mA", "V", "mV", "%"];

interface Props {
  state: State;
  app: App;
  understanding: Understanding;
}

export function Choices({ state, app, understanding }: Props) {
  const { proposal, unfinished } = understanding;
  // Once it was needed it stays open: it must not close during a correction.
  const isOpen = useRef(false);
  isOpen.current ||= proposal === null;
  return (
    <details class="section" open={isOpen.current}>
      <summary><h2>Corrections</h2><span class="hint">columns, units, side, gains, controller, methods, locked joints</span></summary>
      {isOwnText(state.experiment) ? <OwnText app={app} hasProposal={(proposal ?? unfinished) !== null} /> : <Fields state={state} app={app} understanding={understanding} />}
    </details>
  );
}

function OwnText({ app, hasProposal }: { app: App; hasProposal: boolean }) {
  return (
    <div class="buttons">
      <p>The experiment is your own text; edit experiment.toml below.</p>
      {hasProposal && <button type="button" onClick={() => app.useProposal()}>Propose another one</button>}
    </div>
  );
}

function Fields({ state, app, understanding }: Props) {
  const { proposal } = understanding;
  const isBusy = isAtWork(state);
  return (
    <>
      <fieldset disabled={isBusy}>
        <legend class="unseen">Units and side</legend>
        <Signals state={state} app={app} proposal={proposal} />
      </fieldset>
      <fieldset disabled={isBusy}>
        <legend class="unseen">Gains, controller and methods</legend>
        <Estimation state={state} app={app} proposal={proposal} />
      </fieldset>
      <Columns state={state} app={app} understanding={understanding} />
      <p class="buttons">
        <button type="button" disabled={isBusy || Object.keys(state.choices).length === 0} onClick={() => app.chooseNothing()}>Use all as detected</button>
      </p>
    </>
  );
}

/** Units and side of the two signals, and the rate without a time column. */
function Signals({ state, app, proposal }: { state: State; app: App; proposal: ProposalAnswer | null }) {
  const { choices } = state;
  return (
    <div class="fields">
      <Choice label="Unit of positions" found={one(proposal?.position.unit)} value={choices.position_unit} options={POSITION_UNITS}
        choose={(position_unit) => app.choose({ position_unit })} />
      <Choice label="Unit of torques" found={one(proposal?.torque.unit)} value={choices.torque_unit} options={TORQUE_UNITS}
        choose={(torque_unit) => app.choose({ torque_unit })} />
      <Choice label="Measured at" found={proposal?.torque.side} value={choices.side} options={["joint", "motor"]}
        choose={(side) => app.choose({ side: side as Side | undefined })} />
      <label>
        Samples per second, if there is no time
        <input type="number" min="0" step="any" value={choices.rate ?? ""} placeholder={proposal?.time ? "from the time" : ""}
          onChange={(event) => app.choose({ rate: event.currentTarget.valueAsNumber || undefined })} />
      </label>
    </div>
  );
}

function one(unit: string | string[] | undefined): string | undefined {
  return unit === undefined ? undefined : [...new Set([unit].flat())].join(", ");
}

interface ChoiceProps {
  label: string;
  found: string | undefined;
  value: string | undefined;
  options: string[];
  choose: (value: string | undefined) => void;
}

function Choice({ label, found, value, options, choose }: ChoiceProps) {
  return (
    <label>
      {label}
      <select value={value ?? ""} onChange={(event) => choose(event.currentTarget.value || undefined)}>
        <option value="">{value === undefined && found ? `as detected: ${found}` : "as detected"}</option>
        {options.map((option) => <option key={option} value={option}>{option}</option>)}
      </select>
    </label>
  );
}

/** The columns of each joint, used once every joint that moves has both. */
function Columns({ state, app, understanding }: Props) {
  const isBusy = isAtWork(state);
  const [draft, setDraft] = useDraft(state, understanding);
  const assignment = draft ?? assignmentOf(understanding);
  const names = columnNames(understanding.recordings);
  const take = (changed: Assignment) => {
    setDraft(changed);
    const choices = choicesOf(changed);
    if (choices) void app.choose(choices);
  };
  const takeJoint = (joint: JointColumns) => take({ ...assignment, joints: assignment.joints.map((other) => (other.name === joint.name ? joint : other)) });
  return (
    <>
      <div class="fields">
        <ColumnChoice label="Time" inline names={names} value={assignment.time} disabled={isBusy} choose={(time) => take({ ...assignment, time })} />
      </div>
      <div class="scroll" tabIndex={0} role="region" aria-label="Columns of each joint">
        <fieldset disabled={isBusy}><table class="columns">
          <caption>Columns of each joint</caption>
          <thead><tr><th class="lead">joint</th><th class="lead">position</th><th class="lead">torque</th><th class="lead">locked at, rad or m</th></tr></thead>
          <tbody>{assignment.joints.map((joint) => <Row key={joint.name} joint={joint} names={names} take={takeJoint} />)}</tbody>
        </table></fieldset>
      </div>
      {!choicesOf(assignment) && <p class="note">Every joint needs two columns, or a value at which it is locked.</p>}
    </>
  );
}

/** Choices without an answer yet; the proposal that answers them replaces the draft. */
function useDraft({ choices, answered }: State, understanding: Understanding) {
  const [draft, setDraft] = useState<Assignment | null>(null);
  useEffect(() => {
    if (choices === answered && (understanding.proposal || Object.keys(choices).length === 0)) setDraft(null);
  }, [understanding]);
  return [draft, setDraft] as const;
}

function Row({ joint, names, take }: { joint: JointColumns; names: string[]; take: (joint: JointColumns) => void }) {
  const isLocked = joint.locked !== null;
  return (
    <tr>
      <th class="lead" scope="row">{joint.name}</th>
      <td class="lead"><ColumnChoice label={`Position of ${joint.name}`} names={names} value={joint.position} disabled={isLocked}
        choose={(position) => take({ ...joint, position })} /></td>
      <td class="lead"><ColumnChoice label={`Torque of ${joint.name}`} names={names} value={joint.torque} disabled={isLocked}
        choose={(torque) => take({ ...joint, torque })} /></td>
      <td class="lead">
        <input type="checkbox" aria-label={`Lock ${joint.name}`} checked={isLocked} onChange={() => take({ ...joint, locked: isLocked ? null : 0 })} />
        {isLocked && <LockValue name={joint.name} value={joint.locked!} take={(locked) => take({ ...joint, locked })} />}
      </td>
    </tr>
  );
}

/** Keeps the typed text until it is complete. */
function LockValue({ name, value, take }: { name: string; value: number; take: (value: number) => void }) {
  const [typed, setTyped] = useState<string | null>(null);
  const done = (value: number) => {
    setTyped(null);
    take(value || 0);
  };
  return <input type="number" step="any" aria-label={`Value of ${name}`} value={typed ?? value}
    onInput={(event) => setTyped(event.currentTarget.value)} onChange={(event) => done(event.currentTarget.valueAsNumber)} />;
}

interface ColumnChoiceProps {
  label: string;
  names: string[];
  value: string;
  choose: (name: string) => void;
  inline?: boolean;
  disabled?: boolean;
}

function ColumnChoice({ label, names, value, choose, inline = false, disabled = false }: ColumnChoiceProps) {
  const known = value === "" || names.includes(value) ? names : [value, ...names];
  const select = (
    <select aria-label={inline ? undefined : label} value={value} disabled={disabled} onChange={(event) => choose(event.currentTarget.value)}>
      <option value="">{inline ? "none" : "choose"}</option>
      {known.map((name) => <option key={name} value={name}>{name}</option>)}
    </select>
  );
  return inline ? <label>{label}{select}</label> : select;
}
