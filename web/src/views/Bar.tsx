// The bar at the lower edge: the running task, and the next step.

import { useEffect, useState } from "preact/hooks";
import type { State, Task } from "../state";
import { isAtWork, missing } from "../state";
import { stepsIn } from "../steps";
import { sentence } from "../words";
import { headline } from "./Result";
import type { View } from "./Page";

export function Bar({ state, app }: View) {
  const lacks = missing(state);
  return (
    <section class="bar" aria-label="Progress" hidden={state.files.length === 0 && state.task === null && state.linked === null}>
      <div class="inside">
        <p class="status" role="status">{statusOf(state, lacks)}</p>
        {state.task && <Elapsed task={state.task} />}
        {state.task && <button type="button" onClick={() => app.cancel()}>Cancel</button>}
        {!isAtWork(state) && !lacks && (
          <button type="button" class="primary" disabled={state.task !== null} onClick={() => app.identify()}>
            {state.identified ? "Identify again" : "Identify"}
          </button>
        )}
      </div>
      {state.task && <Progress task={state.task} />}
    </section>
  );
}

/** Full where the work ends, if the program counts its steps. */
function Progress({ task }: { task: Task }) {
  const steps = stepsIn(task.stage);
  return steps ? <progress aria-label="Working" value={steps.done} max={steps.of} /> : <progress aria-label="Working" />;
}

function statusOf(state: State, lacks: string | null): string {
  if (state.task) return state.task.stage ? sentence(state.task.stage) : state.said;
  if (state.problem) return "There is an error; see above.";
  if (lacks && state.linked && state.files.length === 0) return "The settings of the link are used for the files that you add.";
  if (lacks) return lacks;
  if (state.identified) return headline(state.identified);
  return state.said === "Cancelled." ? "Cancelled." : "Ready to identify.";
}

/** Seconds since the work began. */
function Elapsed({ task }: { task: Task }) {
  const [now, setNow] = useState(Date.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), 500);
    return () => clearInterval(timer);
  }, [task.name]);
  const elapsed = Math.max(0, Math.round((now - task.since) / 1000));
  return <span class="elapsed" aria-hidden="true">{elapsed} s</span>;
}
