// Remedies that are settings: a button for each, and what the last one changed.

import { useState } from "preact/hooks";
import type { Remedy } from "../contract";
import { capital } from "../words";
import type { View } from "./Page";
import { Report } from "./Report";

/** Applies a remedy and identifies again. */
export function RemedyButton({ state, app, remedies, remedy }: View & { remedies: Remedy[]; remedy: Remedy }) {
  const isDisabled = state.task !== null || state.experiment === null;
  return (
    <p class="buttons">
      <button type="button" disabled={isDisabled} title={changesOf(remedy)} onClick={() => app.mend(remedies, remedy)}>{remedy.label}, and identify</button>
    </p>
  );
}

/** The findings of a run that a setting mends. */
export function Remedies({ state, app }: View) {
  const remedies = state.identified?.results.remedies ?? [];
  // A remedy is of the text that was identified: in another one it may be there already.
  if (remedies.length === 0 || state.identified?.experiment !== state.experiment?.text) return null;
  // Of a good result they only improve it.
  const severity = state.identified?.results.verdict === "good" ? "note" : "warning";
  return (
    <ul class="findings" aria-label="Remedies">
      {remedies.map((remedy) => (
        <li key={remedy.code} class="finding" data-severity={severity}>
          <p>{capital(remedy.found)}</p>
          <RemedyButton state={state} app={app} remedies={remedies} remedy={remedy} />
        </li>
      ))}
    </ul>
  );
}

/** What the last remedy changed against the run before, and the report of that run. */
export function Change({ state: { changed } }: Pick<View, "state">) {
  const [isOpen, setOpen] = useState(false);
  if (!changed) return null;
  return (
    <div class="after">
      <h3>{changed.label}: done</h3>
      <pre class="changed" tabIndex={0} role="region" aria-label={`Change by: ${changed.label}`}>{changed.text}</pre>
      <details onToggle={(event) => setOpen(event.currentTarget.open)}>
        <summary>The report before</summary>
        {isOpen && <Report html={changed.before.report} title="The report before" />}
      </details>
    </div>
  );
}

function changesOf({ changes }: Remedy): string {
  return changes.map(({ key, before, after }) => `${key}: ${after ?? "removed"}${before === null ? "" : `, instead of ${before}`}`).join("\n");
}
