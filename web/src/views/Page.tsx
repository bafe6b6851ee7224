// The whole page: files, what was read, the experiment, the result, and the bar with the next step.

import { useErrorBoundary } from "preact/hooks";
import type { App } from "../app";
import type { State } from "../state";
import { Bar } from "./Bar";
import { Experiment } from "./Experiment";
import { Files } from "./Files";
import { Result } from "./Result";
import { Understood } from "./Understood";

/** The version and the address of the source; esbuild sets both from Cargo.toml. */
declare const VERSION: string;
declare const REPOSITORY: string;

export interface View {
  state: State;
  app: App;
}

export function Page({ state, app }: View) {
  const [error, reset] = useErrorBoundary();
  if (error) return <Failed error={error} startAnew={() => { app.startAnew(); reset(); }} />;
  return (
    <>
      <header>
        <h1>thetahat</h1>
        <p class="says">
          Estimates the inertias, masses and friction of a robot from a log of its positions and torques.
          Everything is computed in this page: <strong>no file leaves your computer</strong>.
        </p>
      </header>
      <main>
        <Files state={state} app={app} />
        {state.understanding && <Understood state={state} app={app} understanding={state.understanding} />}
        {state.experiment && <Experiment state={state} app={app} experiment={state.experiment} />}
        <Result state={state} app={app} />
      </main>
      <footer>
        <p>thetahat {VERSION}, MIT or Apache-2.0. The same program runs as a command, for recordings of any length.</p>
        <ul class="links" aria-label="Links">
          <li><a href={`${REPOSITORY}/blob/main/docs/manual/browser.md`}>How to use this page</a></li>
          <li><a href={`${REPOSITORY}/blob/main/docs/README.md`}>Documentation</a></li>
          <li><a href={REPOSITORY}>Source</a></li>
          <li><a href={`${REPOSITORY}/blob/main/CHANGELOG.md`}>Changes</a></li>
        </ul>
      </footer>
      <Bar state={state} app={app} />
    </>
  );
}

/** Shown if a view fails. */
function Failed({ error, startAnew }: { error: Error; startAnew: () => void }) {
  return (
    <main>
      <h1>thetahat</h1>
      <p class="error" role="alert">The page itself failed; this is a bug in thetahat: {error.message}</p>
      <p class="buttons"><button type="button" onClick={startAnew}>Start over</button></p>
    </main>
  );
}
