// The actions of the user and their effects.

import { Cancelled, Client, SessionError, Trapped } from "./client";
import type { Exported, Identified, InitRequest, Kind, LinkBody, Remedy, SampleAnswer, SampleName, Understanding } from "./contract";
import type { Keeper } from "./kept";
import { linkedIn, linkOf, type Linked } from "./link";
import { withoutArchives } from "./given";
import { isMesh } from "./meshes";
import { save } from "./save";
import { EMPTY, isOwnText, requestOf, type Choices, type Experiment, type ExportFormat, type ListedFile, type Problem, type Run, type State, type TaskName } from "./state";

/** A file as it was dropped or chosen, with its path below what was dropped. */
export interface GivenFile {
  path: string;
  file: File;
}

/** Largest size of a file, MiB. The session also checks the sum of all files, but only after reading them into memory. */
const LARGEST_FILE = 160;

export class App {
  state: State = EMPTY;
  /** The last of the tasks, which run one after another. */
  private queue: Promise<unknown> = Promise.resolve();
  /** Whether a task that has not begun will read the files. */
  private willUnderstand = false;

  constructor(
    private readonly client: Client,
    private readonly changed: (state: State) => void,
    private readonly keeper: Keeper,
  ) {}

  /** Begins with a link's settings, or else with what a reload of this tab left. */
  async begin(fragment: string): Promise<void> {
    const linked = linkedIn(fragment);
    if (linked !== null) return this.follow(linked);
    const kept = await this.keeper.find();
    // What was done in the meantime counts.
    if (!kept || this.state !== EMPTY) return;
    this.client.restore(kept.files, kept.state.sample);
    this.set(kept.state);
    if (!this.state.understanding) await this.understand();
  }

  /** Takes the settings of a link; those without a sample wait for files. */
  async follow(linked: Linked | string): Promise<void> {
    this.startAnew();
    if (typeof linked === "string") return this.set({ problem: { at: "read", message: linked } });
    const { sample, choices, experiment } = linked;
    if (sample) return this.sample(sample, linked);
    const text: Experiment | null = experiment === null ? null : { text: experiment, origin: "given" };
    this.set({ linked: choices, choices, experiment: text, said: "The settings of the link are used for the files that you add." });
  }

  /** The link with these settings. */
  link(page: string): string {
    return linkOf(this.state, page);
  }

  /** Gives a file to the user. */
  save(name: string, text: string): void {
    save(name, text);
    this.set({ isUnsaved: false });
  }

  /** Adds files and reads them together. */
  async add(given: GivenFile[]): Promise<void> {
    if (this.state.sample) this.startAnew();
    await this.task("read", async () => {
      for (const { path, file } of await withoutArchives(given)) {
        this.say(`Reading ${path}.`);
        await this.addOne(path, file);
      }
    });
    if (!this.state.problem) await this.understand();
  }

  /** Removes all meshes. */
  async removeMeshes(): Promise<void> {
    for (const path of this.meshes.keys()) await this.client.remove(path);
    this.set({ files: this.state.files.filter(({ kind }) => kind !== "mesh"), said: "The meshes are removed." });
  }

  /** The files of surfaces next to the robot, by their paths. */
  get meshes(): ReadonlyMap<string, Blob> {
    return new Map([...this.client.given].filter(([path]) => isMesh(path)));
  }

  /** The URDF of the robot; empty for another format. */
  async urdf(): Promise<{ path: string; text: string }> {
    const { robot } = requestOf(this.state);
    return robot === undefined ? { path: "", text: "" } : { path: robot, text: await this.client.call("urdf", [robot]) };
  }

  /** The bodies that a run identified. */
  async bodies(run: Run): Promise<LinkBody[]> {
    return JSON.parse(await this.client.call("bodies", [resultsOf(run)])) as LinkBody[];
  }

  async remove(path: string): Promise<void> {
    const file = this.state.files.find((listed) => listed.path === path);
    this.set({ files: this.state.files.filter((listed) => listed !== file), identified: null, said: `${path} is removed.` });
    if (file?.kind === "experiment") this.set({ experiment: null });
    if (file?.kind === "robot" || file?.kind === "recording") this.set({ choices: this.state.linked ?? {} });
    await this.client.remove(path).catch(() => {});
    await this.understand();
  }

  /** Records a simulated robot, and takes the settings of a link to it. */
  async sample(name: SampleName, { choices, experiment: own }: Pick<Linked, "choices" | "experiment"> = { choices: {}, experiment: null }): Promise<void> {
    this.startAnew();
    await this.task("read", async () => {
      this.say("Recording the simulated robot.");
      const { request, experiment } = JSON.parse(await this.client.sample(name)) as SampleAnswer;
      const text = own ?? experiment;
      this.set({ sample: name, files: sampleFiles(request), choices, experiment: text === null ? null : { text, origin: "given" } });
    });
    if (!this.state.problem) await this.understand();
  }

  /** Forgets everything. */
  startAnew(): void {
    this.client.clear();
    this.state = EMPTY;
    this.keeper.keep(this.state, this.client.given);
    this.changed(this.state);
  }

  /** Replaces the proposal by a choice; `undefined` reverts it. */
  async choose(change: { [key in keyof Choices]: Choices[key] | undefined }): Promise<void> {
    const choices = Object.fromEntries(Object.entries({ ...this.state.choices, ...change }).filter(([, value]) => value !== undefined));
    this.set({ choices });
    await this.understand();
  }

  /** Reverts all choices. */
  async chooseNothing(): Promise<void> {
    this.set({ choices: {}, linked: null });
    await this.understand();
  }

  /** Sets the text of the experiment as edited by hand. */
  edit(text: string): void {
    this.set({ experiment: { text, origin: "edited" } });
  }

  /** Replaces the user's own text by the proposal. */
  useProposal(): void {
    this.set({ experiment: proposedIn(this.state.understanding) });
  }

  /** Chooses the filter from the data, as `thetahat init` does. */
  async chooseFilter(): Promise<void> {
    await this.task("propose", () => this.propose());
  }

  async identify(): Promise<void> {
    this.set({ identified: null, exported: null, changed: null });
    if (await this.isChosen()) await this.task("identify", () => this.run());
  }

  /** Applies a remedy to the experiment and identifies again; the run before stays for comparison. */
  async mend(remedies: Remedy[], { code, label }: Remedy): Promise<void> {
    const before = this.state.identified;
    if (!(await this.isChosen())) return;
    const isApplied = await this.task("apply", async () => {
      const { text } = this.state.experiment!;
      const mended = await this.client.call("apply", [text, JSON.stringify(remedies), JSON.stringify([code])]);
      this.set({ experiment: { text: mended, origin: "mended" }, said: `${label}: applied.` });
    });
    if (!isApplied) return;
    this.set({ identified: null, exported: null, changed: null });
    if (!(await this.task("identify", () => this.run())) || !before) return;
    await this.task("identify", async () => {
      const [old, own] = [before, this.state.identified!].map(resultsOf);
      this.set({ changed: { label, before, text: await this.client.call("changed", [old, own]) } });
    });
  }

  /** Chooses the filter of a proposal that has none yet. */
  private async isChosen(): Promise<boolean> {
    return this.state.experiment?.origin !== "proposed" || this.task("propose", () => this.propose());
  }

  cancel(): void {
    this.client.cancel();
  }

  async export(format: ExportFormat, untrusted: boolean): Promise<void> {
    const { identified } = this.state;
    if (!identified) return;
    const results = resultsOf(identified);
    await this.task("export", async () => {
      const answer = JSON.parse(await this.client.call("export", [results, format, untrusted])) as Exported;
      this.set({ exported: { format, answer }, said: `The robot is written as ${format.toUpperCase()}.` });
    });
  }

  private async addOne(path: string, file: File): Promise<void> {
    const listed: ListedFile = { path, bytes: file.size, kind: isMesh(path) ? "mesh" : null, error: tooLarge(path, file.size) };
    if (listed.error === null) await this.recognise(listed, file);
    const replaced = (other: ListedFile) => other.path === path || (isSingle(listed) && other.kind === listed.kind);
    const files = [...this.state.files.filter((other) => !replaced(other)), listed];
    this.set(listed.kind === "mesh" ? { files } : { files, identified: null });
    if (listed.kind === "robot" || listed.kind === "recording") this.set({ choices: this.state.linked ?? {} });
    if (listed.kind === "experiment") this.set({ experiment: { text: await file.text(), origin: "given" } });
  }

  private async recognise(listed: ListedFile, file: File): Promise<void> {
    try {
      await this.client.put(listed.path, file);
      if (listed.kind === "mesh") return;
      listed.kind = (await this.client.call("kind", [listed.path])) as Kind;
      if (listed.kind === "unknown") listed.error = await this.whyNotRead(listed.path);
      if (listed.kind === "results") listed.error = "These are results. This page needs a robot, its logs and an experiment.";
    } catch (error) {
      if (error instanceof Cancelled) throw error;
      listed.error = sentenceOf(error);
    }
  }

  /** The error of the readers for an unknown file. */
  private async whyNotRead(path: string): Promise<string> {
    const request: InitRequest = { recordings: [path] };
    const { recording_errors: errors } = JSON.parse(await this.client.call("understand", [JSON.stringify(request)])) as Understanding;
    return errors[0]?.message ?? "This is not a robot, log or experiment.";
  }

  /** Reads the files with the choices, once for all changes before it begins. */
  private async understand(): Promise<void> {
    if (this.willUnderstand) return;
    this.willUnderstand = true;
    await this.task("understand", () => {
      this.willUnderstand = false;
      return this.understandOnce();
    });
  }

  private async understandOnce(): Promise<void> {
    const { choices } = this.state;
    const request = requestOf(this.state);
    if (request.robot === undefined && request.recordings.length === 0) {
      return this.set({ understanding: null, experiment: isOwnText(this.state.experiment) ? this.state.experiment : null });
    }
    this.say("Reading the files.");
    const understanding = JSON.parse(await this.client.call("understand", [JSON.stringify(request)])) as Understanding;
    const files = this.state.files.map((file) => withError(file, request, understanding));
    this.set({ understanding, answered: choices, files, said: "The files are read." });
    if (!isOwnText(this.state.experiment)) this.useProposal();
  }

  private async propose(): Promise<void> {
    this.say("Choosing the filter from the data.");
    const request = JSON.stringify(requestOf(this.state));
    const text = await this.client.call("propose", [request], (stage) => this.stage(stage));
    this.set({ experiment: { text, origin: "chosen" }, said: "The filter is chosen." });
  }

  private async run(): Promise<void> {
    this.say("Identifying.");
    const experiment = this.state.experiment?.text ?? "";
    const answer = await this.client.call("identify", [experiment], (stage) => this.stage(stage));
    this.set({ identified: { ...(JSON.parse(answer) as Identified), experiment }, isUnsaved: this.state.sample === null });
  }

  /** Runs a task after the previous ones; its error is shown where it belongs. Returns whether it succeeded. */
  private task(name: TaskName, work: () => Promise<void>): Promise<boolean> {
    const done = this.queue.then(() => this.runTask(name, work));
    this.queue = done;
    return done;
  }

  private async runTask(name: TaskName, work: () => Promise<void>): Promise<boolean> {
    this.set({ task: { name, stage: "", since: Date.now() }, problem: null });
    try {
      await work();
      return true;
    } catch (error) {
      this.set({ problem: problemOf(name, error), said: error instanceof Cancelled ? "Cancelled." : "" });
      return false;
    } finally {
      this.set({ task: null });
    }
  }

  private stage(stage: string): void {
    if (this.state.task) this.set({ task: { ...this.state.task, stage } });
  }

  private say(said: string): void {
    this.set({ said });
  }

  private set(change: Partial<State>): void {
    this.state = { ...this.state, ...change };
    this.keeper.keep(this.state, this.client.given);
    this.changed(this.state);
  }
}

/** A file with its error, if it was read. */
function withError(file: ListedFile, request: InitRequest, answer: Understanding): ListedFile {
  if (file.path === request.robot) return { ...file, error: answer.robot_error };
  if (!request.recordings.includes(file.path)) return file;
  return { ...file, error: answer.recording_errors.find(({ path }) => path === file.path)?.message ?? null };
}

function proposedIn(understanding: Understanding | null): Experiment | null {
  if (understanding?.proposal) return { text: understanding.proposal.toml, origin: "proposed" };
  return understanding?.unfinished ? { text: understanding.unfinished, origin: "unfinished" } : null;
}

/** Whether a file of this kind replaces another one. */
function isSingle({ kind }: ListedFile): boolean {
  return kind === "robot" || kind === "experiment";
}

function sampleFiles({ robot, recordings }: InitRequest): ListedFile[] {
  const listed = (kind: Kind) => (path: string) => ({ path, bytes: 0, kind, error: null });
  return [...(robot === undefined ? [] : [robot]).map(listed("robot")), ...recordings.map(listed("recording"))];
}

function tooLarge(path: string, bytes: number): string | null {
  const found = Math.floor(bytes / 2 ** 20);
  if (found <= LARGEST_FILE) return null;
  return `${path}: ${found} MiB, more than the ${LARGEST_FILE} MiB that the page can read; the command \`thetahat reduce\` reads recordings of any `
    + "length, and `thetahat solve` identifies from its output";
}

/** The text of `results.json`. */
function resultsOf(run: Run): string {
  return run.files["results.json"] ?? JSON.stringify(run.results);
}

function problemOf(at: TaskName, error: unknown): Problem | null {
  return error instanceof Cancelled ? null : { at, message: sentenceOf(error) };
}

function sentenceOf(error: unknown): string {
  if (error instanceof SessionError) return error.message;
  if (error instanceof Trapped) return `The program stopped: ${error.message}. Your files are still here; try again, or remove the file that caused it.`;
  return String(error);
}
