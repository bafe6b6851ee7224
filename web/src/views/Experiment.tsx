// The experiment file, as `thetahat init` writes it: to read, edit and save.

import type { Experiment as Text, Origin } from "../state";
import type { View } from "./Page";

const ORIGINS: Record<Origin, string> = {
  proposed: "Proposed, with the usual filter. Identify first chooses the filter from the data.",
  unfinished: "Proposed: give the gain under Corrections, or fill it in as explained in the text; then identify.",
  chosen: "Proposed, with the filter chosen from the data.",
  edited: "Edited by hand.",
  mended: "Changed by a remedy; the comment at the start says what.",
  given: "As given.",
};

export function Experiment({ state, app, experiment }: View & { experiment: Text }) {
  const lines = experiment.text.split("\n").length;
  return (
    <details class="section" id="experiment" open>
      <summary><h2>experiment.toml</h2><span class="hint">{ORIGINS[experiment.origin]}</span></summary>
      <p class="buttons">
        {experiment.origin === "proposed" && (
          <button type="button" disabled={state.task !== null} onClick={() => app.chooseFilter()}>Choose the filter now</button>
        )}
        {(experiment.origin === "edited" || experiment.origin === "mended") && (state.understanding?.proposal || state.understanding?.unfinished) && (
          <button type="button" onClick={() => app.useProposal()}>Use the proposal again</button>
        )}
        <button type="button" onClick={() => app.save("experiment.toml", experiment.text)}>Save experiment.toml</button>
      </p>
      <textarea aria-label="experiment.toml" spellcheck={false} rows={Math.min(22, lines)} value={experiment.text}
        readOnly={state.task !== null} onInput={(event) => app.edit(event.currentTarget.value)} />
    </details>
  );
}
