// All that the page shows, as one value.

import type { Exported, Identified, InitRequest, Kind, SampleName, Understanding } from "./contract";

export interface ListedFile {
  path: string;
  bytes: number;
  /** Null while unknown. */
  kind: Kind | "mesh" | null;
  /** Why it is not used. */
  error: string | null;
}

/** Where the text of the experiment comes from: proposed at once, proposed with something to be filled in by hand, with the filter chosen from the data, changed by hand or by a remedy, or given as a file. */
export type Origin = "proposed" | "unfinished" | "chosen" | "edited" | "mended" | "given";

export interface Experiment {
  text: string;
  origin: Origin;
}

/** A run's answer, and the text of the experiment that it answers. */
export interface Run extends Identified {
  experiment: string;
}

/** What a run with a remedy changed against the run before, which stays. */
export interface Changed {
  /** What the remedy does. */
  label: string;
  before: Run;
  text: string;
}

export type TaskName = "read" | "understand" | "propose" | "identify" | "apply" | "export";

export interface Task {
  name: TaskName;
  stage: string;
  since: number;
}

/** An error and the task that caused it. */
export interface Problem {
  at: TaskName;
  message: string;
}

/** The user's choices instead of the proposal: the arguments of `thetahat init`. */
export type Choices = Omit<InitRequest, "robot" | "recordings">;

export type ExportFormat = "urdf" | "mjcf" | "sdf" | "json";

export interface State {
  files: ListedFile[];
  choices: Choices;
  /** The choices that `understanding` answers. */
  answered: Choices;
  /** The sample whose files these are; null if they were given. */
  sample: SampleName | null;
  /** Settings of a link, for the files that will be given. */
  linked: Choices | null;
  understanding: Understanding | null;
  experiment: Experiment | null;
  identified: Run | null;
  /** Whether nothing of the result was saved. */
  isUnsaved: boolean;
  /** Null if the last run had no remedy, or none before it. */
  changed: Changed | null;
  /** The answer of the last export. */
  exported: { format: ExportFormat; answer: Exported } | null;
  task: Task | null;
  problem: Problem | null;
  /** The last thing that happened, for screen readers. */
  said: string;
}

export const EMPTY: State = {
  files: [],
  choices: {},
  answered: {},
  sample: null,
  linked: null,
  understanding: null,
  experiment: null,
  identified: null,
  isUnsaved: false,
  changed: null,
  exported: null,
  task: null,
  problem: null,
  said: "",
};

/** Whether the text is the user's own, so that choices do not affect it. */
export function isOwnText(experiment: Experiment | null): boolean {
  return experiment !== null && ["edited", "mended", "given"].includes(experiment.origin);
}

/** Whether the filter is being chosen or the robot identified: the inputs must not change. */
export function isAtWork({ task }: State): boolean {
  return task?.name === "propose" || task?.name === "identify" || task?.name === "apply";
}

/** The arguments of `thetahat init` for the files and choices. */
export function requestOf({ files, choices }: State): InitRequest {
  const used = files.filter((file) => file.error === null);
  const robot = used.find((file) => file.kind === "robot")?.path;
  const recordings = used.filter((file) => file.kind === "recording").map((file) => file.path);
  return { ...choices, recordings, ...(robot === undefined ? {} : { robot }) };
}

/** What is missing before anything can be identified. */
export function missing({ understanding, experiment }: State): string | null {
  if (experiment?.origin === "unfinished") return "Fill in the gain, under Corrections or in experiment.toml.";
  if (experiment) return null;
  if (!understanding) return "Add a robot and its log.";
  if (!understanding.robot) return "Add the robot: a URDF or TOML file.";
  if (understanding.recordings.length === 0) return "Add the log of its positions and torques.";
  return "Say which columns are which, below.";
}
