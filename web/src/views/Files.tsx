// The files: dropped, chosen, or those of the demo, each with its kind or the reason why it is not used.

import { useEffect, useRef, useState } from "preact/hooks";
import type { GivenFile } from "../app";
import type { Kind, SampleName } from "../contract";
import { droppedFiles } from "../dropped";
import { LOGS, ROBOTS } from "../given";
import type { ListedFile } from "../state";
import { size } from "../words";
import { SAMPLE_NOTES, Samples } from "./Samples";
import { ShareLink } from "./ShareLink";
import type { View } from "./Page";

const KINDS: Record<Kind | "mesh", string> = {
  mesh: "mesh",
  robot: "robot",
  experiment: "experiment",
  results: "results",
  recording: "log",
  unknown: "not used",
};

export function Files({ state, app }: View) {
  const isOver = useDrop((files) => app.add(files));
  const isEmpty = state.files.length === 0;
  return (
    <section id="files" aria-labelledby="files-title">
      <h2 id="files-title">Robot and log</h2>
      <div class={`drop ${isOver ? "over" : ""} ${isEmpty ? "" : "small"}`}>
        <p><strong>Drop a robot and its log here</strong>, or choose them:</p>
        <p class="buttons">
          <FileButton label="Choose robot" accept={ROBOTS} take={(files) => app.add(files)} />
          <FileButton label="Choose logs" accept={LOGS} take={(files) => app.add(files)} />
          {!isEmpty && <button type="button" onClick={() => app.sample("demo")}>Try the demo</button>}
          {!isEmpty && <button type="button" onClick={() => app.startAnew()}>Start over</button>}
          {!isEmpty && <ShareLink state={state} app={app} />}
        </p>
        {isEmpty && <Accepted />}
      </div>
      {isEmpty && state.linked && <p class="note">The settings of the link are used for the files that you add. <button type="button" onClick={() => app.startAnew()}>Without them</button></p>}
      {state.problem && (state.problem.at === "read" || (state.problem.at === "understand" && !state.understanding)) && <p class="error" role="alert">{state.problem.message}</p>}
      {isEmpty && <Samples state={state} app={app} />}
      {!isEmpty && <List files={state.files} sample={state.sample} remove={(path) => app.remove(path)} removeMeshes={() => app.removeMeshes()} />}
    </section>
  );
}

/** Receives files that are dropped anywhere on the page; returns whether files are over it. */
function useDrop(take: (files: GivenFile[]) => void): boolean {
  const [isOver, setOver] = useState(false);
  useEffect(() => {
    const listeners = new AbortController();
    const on = (type: "dragover" | "dragleave" | "drop", act: (event: DragEvent) => void) =>
      window.addEventListener(type, (event) => { event.preventDefault(); act(event); }, { signal: listeners.signal });
    on("dragover", () => setOver(true));
    on("dragleave", (event) => setOver(event.relatedTarget !== null));
    on("drop", async (event) => {
      setOver(false);
      if (event.dataTransfer) take(await droppedFiles(event.dataTransfer));
    });
    return () => listeners.abort();
  }, []);
  return isOver;
}

function Accepted() {
  return (
    <dl class="accepted">
      <dt>Robot</dt><dd>URDF, also with its meshes as a folder or zip, or a TOML file with Denavit-Hartenberg parameters</dd>
      <dt>Log</dt><dd>joint positions and torques as CSV, NumPy, MATLAB, Parquet or a ROS 2 bag; one file or several</dd>
      <dt>Experiment</dt><dd>an <code>experiment.toml</code> of the command line, if you have one</dd>
    </dl>
  );
}

/** A button that opens the chooser of files. */
function FileButton({ label, accept, take }: { label: string; accept: string; take: (files: GivenFile[]) => void }) {
  const input = useRef<HTMLInputElement>(null);
  const chosen = () => {
    const files = [...(input.current?.files ?? [])];
    take(files.map((file) => ({ path: file.name, file })));
    if (input.current) input.current.value = "";
  };
  return (
    <>
      <button type="button" class="primary" onClick={() => input.current?.click()}>{label}</button>
      <input ref={input} type="file" multiple hidden accept={accept} aria-label={label} onChange={chosen} />
    </>
  );
}

interface ListProps {
  files: ListedFile[];
  sample: SampleName | null;
  remove: (path: string) => void;
  removeMeshes: () => void;
}

/** The files, all meshes in one line. */
function List({ files, sample, remove, removeMeshes }: ListProps) {
  const isInLine = ({ kind, error }: ListedFile) => kind === "mesh" && error === null;
  const meshes = files.filter(isInLine);
  return (
    <ul class="files" aria-label="Files">
      {files.filter((file) => !isInLine(file)).map((file) => (
        <li key={file.path}>
          <span class="name">{file.path}</span>
          <span class="kind">{file.kind === null ? "not read" : KINDS[file.kind]}{file.bytes > 0 && `, ${size(file.bytes)}`}</span>
          {!sample && <button type="button" aria-label={`Remove ${file.path}`} onClick={() => remove(file.path)}>Remove</button>}
          {file.error && <p class="error" role="alert">{file.error}</p>}
        </li>
      ))}
      {meshes.length > 0 && (
        <li>
          <span class="name">{meshes.length === 1 ? "1 mesh" : `${meshes.length} meshes`}</span>
          <span class="kind">drawn in 3D, {size(meshes.reduce((sum, { bytes }) => sum + bytes, 0))}</span>
          <button type="button" aria-label="Remove the meshes" onClick={removeMeshes}>Remove</button>
        </li>
      )}
      {sample && <li class="note">{SAMPLE_NOTES[sample]}</li>}
    </ul>
  );
}
