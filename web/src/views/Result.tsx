// The result: the report as the library makes it, and the files to keep.

import { useEffect, useRef } from "preact/hooks";
import type { Verdict } from "../contract";
import type { ExportFormat, Run } from "../state";
import type { View } from "./Page";
import { Change, Remedies } from "./Remedies";
import { Report } from "./Report";

const VERDICTS: Record<Verdict, string> = { good: "good", care: "use with care", "do-not-use": "do not use" };

/** Formats of exported robots, with their extensions. */
const FORMATS: [ExportFormat, string][] = [["urdf", "urdf"], ["mjcf", "xml"], ["sdf", "sdf"], ["json", "json"]];

/** The verdict in a sentence. */
export function headline({ results }: Run): string {
  const recommended = results.advice[0]?.recommended;
  const method = recommended && results.verdict !== "do-not-use" ? ` Recommended method: ${recommended}.` : "";
  return results.verdict ? `Verdict: ${VERDICTS[results.verdict]}.${method}` : "There is no verdict.";
}

export function Result({ state, app }: View) {
  const { identified, problem } = state;
  if (problem && (problem.at === "identify" || problem.at === "propose" || problem.at === "apply")) {
    return (
      <section id="result" aria-labelledby="result-title">
        <Title key={problem.message} />
        <p class="error" role="alert">{problem.message}</p>
      </section>
    );
  }
  if (!identified) return null;
  return (
    <section id="result" aria-labelledby="result-title">
      <Title key={identified.report} />
      {identified.experiment !== state.experiment?.text && <p class="note">The experiment has changed since; identify again.</p>}
      <Change state={state} />
      <Remedies state={state} app={app} />
      <Downloads state={state} app={app} run={identified} />
      <Report html={identified.report} />
    </section>
  );
}

/** The title of a new result, which gets the focus. */
function Title() {
  const title = useRef<HTMLHeadingElement>(null);
  useEffect(() => {
    title.current?.focus({ preventScroll: true });
    title.current?.scrollIntoView();
  }, []);
  return <h2 id="result-title" tabIndex={-1} ref={title}>Result</h2>;
}

function Downloads({ state, app, run }: View & { run: Run }) {
  const files = Object.entries({ "report.html": run.report, ...run.files, "experiment.toml": run.experiment });
  const isRefused = state.problem?.at === "export" && run.results.verdict === "do-not-use";
  return (
    <div class="downloads">
      <p class="buttons">
        <span>Save</span>
        {files.map(([name, text]) => (
          <button type="button" key={name} onClick={() => app.save(name, text)}>{name}</button>
        ))}
      </p>
      <p class="buttons">
        <span>The robot as</span>
        {FORMATS.map(([format]) => (
          <button type="button" key={format} disabled={state.task !== null} onClick={() => app.export(format, false)}>{format.toUpperCase()}</button>
        ))}
      </p>
      {state.problem?.at === "export" && <p class="error" role="alert">{state.problem.message}</p>}
      {isRefused && <p class="buttons"><button type="button" onClick={() => app.export("urdf", true)}>Write the URDF anyway</button></p>}
      {state.exported && <Exported state={state} app={app} run={run} />}
    </div>
  );
}

/** The remarks on the export, and its files. */
function Exported({ state, app, run }: View & { run: Run }) {
  const { format, answer } = state.exported!;
  const name = `${run.results.robot}.${new Map(FORMATS).get(format)}`;
  return (
    <div class="exported">
      <p class="buttons">
        <button type="button" onClick={() => app.save(name, answer.file)}>{name}</button>
        {answer.covariance && <button type="button" onClick={() => app.save(`${name}.covariance.json`, answer.covariance!)}>{name}.covariance.json</button>}
      </p>
      <pre tabIndex={0} role="region" aria-label="Remarks on the export">{answer.text}</pre>
    </div>
  );
}
