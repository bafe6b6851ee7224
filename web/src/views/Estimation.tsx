// Corrections of the estimation: gains of the torques, the controller and the methods.

import { useState } from "preact/hooks";
import type { App } from "../app";
import type { ProposalAnswer } from "../contract";
import type { State } from "../state";

const METHODS = ["idim-ls", "idim-wls", "idim-iv", "idim-piv", "didim", "clie", "cloe"];
/** What is proposed of a log with torques. */
const USUAL = ["idim-wls", "idim-iv"];
/** Methods that simulate the loop with the robot's own controller. */
const NEED_CONTROLLER = ["didim", "clie", "cloe"];

export function Estimation({ state: { choices }, app, proposal }: { state: State; app: App; proposal: ProposalAnswer | null }) {
  const hasTorques = proposal === null || proposal.torque.columns.length > 0;
  const methods = choices.methods ?? USUAL;
  const isWithout = choices.position_gain === undefined || choices.velocity_gain === undefined;
  const choose = (method: string, isChosen: boolean) => {
    const chosen = METHODS.filter((other) => (other === method ? isChosen : methods.includes(other)));
    void app.choose({ methods: chosen.length === 0 || String(chosen) === String(USUAL) ? undefined : chosen });
  };
  return (
    <>
      <div class="fields">
        <Numbers label="Drive gain: torque for 1 A, 1 V or 100 %" unit="N m" value={choices.gain} found={proposal?.gain} take={(gain) => app.choose({ gain })} />
        <Numbers label="Position gain of the controller" unit="N m/rad" value={choices.position_gain} take={(position_gain) => app.choose({ position_gain })} />
        <Numbers label="Velocity gain of the controller" unit="N m s/rad" value={choices.velocity_gain} take={(velocity_gain) => app.choose({ velocity_gain })} />
      </div>
      <p class="note">One number for all joints, or one for each, separated by commas. Of currents the drive gain is the torque constant times the gear ratio.</p>
      {hasTorques && (
        <div class="fields methods" role="group" aria-label="Methods">
          <span aria-hidden="true">Methods</span>
          {METHODS.map((method) => (
            <label key={method} class="check">
              <input type="checkbox" checked={methods.includes(method)} onChange={(event) => choose(method, event.currentTarget.checked)} />{method.toUpperCase()}
            </label>
          ))}
        </div>
      )}
      {hasTorques && isWithout && methods.some((method) => NEED_CONTROLLER.includes(method)) && (
        <p class="note">DIDIM, CLIE and CLOE simulate the robot with its controller: give both of its gains.</p>
      )}
    </>
  );
}

interface NumbersProps {
  label: string;
  unit: string;
  value: number[] | undefined;
  found?: number[] | undefined;
  take: (numbers: number[] | undefined) => void;
}

/** A list of numbers as text, taken once it is complete. */
function Numbers({ label, unit, value, found, take }: NumbersProps) {
  const [wrong, setWrong] = useState<string | null>(null);
  const change = (text: string) => {
    const numbers = numbersIn(text);
    setWrong(numbers ? null : text);
    if (numbers) take(numbers.length === 0 ? undefined : numbers);
  };
  return (
    <label>
      {label}, {unit}
      <input type="text" inputMode="decimal" value={wrong ?? value?.join(", ") ?? ""} placeholder={found?.length ? found.join(", ") : "not given"}
        aria-invalid={wrong !== null} onChange={(event) => change(event.currentTarget.value)} />
      {wrong !== null && <span class="wrong" role="alert">Numbers separated by commas, such as 0.5, 0.5, 0.2</span>}
    </label>
  );
}

/** The numbers of a text; null where something else is in it. */
export function numbersIn(text: string): number[] | null {
  const numbers = text.split(/[\s,;]+/).filter((part) => part !== "").map(Number);
  return numbers.every(Number.isFinite) ? numbers : null;
}
