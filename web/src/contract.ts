// The answers of `thetahat-web`, as JSON texts. Units are SI unless the name has another.

/** The kind of a file, by its content. */
export type Kind = "robot" | "experiment" | "results" | "recording" | "unknown";

export type Side = "joint" | "motor";

/** The arguments of `thetahat init`. */
export interface InitRequest {
  robot?: string;
  recordings: string[];
  position?: string[];
  torque?: string[];
  time?: string;
  joints?: string[];
  rate?: number;
  position_unit?: string;
  torque_unit?: string;
  side?: Side;
  window_s?: [number, number];
  locked?: Record<string, number>;
  /** Torque for 1 A, 1 V or 100 %, one for all joints or one for each. */
  gain?: number[];
  /** Of the controller, likewise. */
  position_gain?: number[];
  velocity_gain?: number[];
  methods?: string[];
}

/** The part of `thetahat model --json` that is shown. */
export interface RobotAnswer {
  name: string;
  format: string;
  /** Joints that follow another joint have no coordinate. */
  joints: { name: string; coordinate: number | null }[];
  locked: { name: string; value: number }[];
  /** Physically impossible values. */
  doubts: { place: string; what: string; remedy: string }[];
  problem: string | null;
}

/** Positions of the joints and axes of their links at some instants of the recording. */
export interface Skeleton {
  /** The axis of a joint is given in the axes of its link. */
  joints: { name: string; kind: string; parent: number | null; axis: Point }[];
  gravity: Point;
  frames: Point[][];
  /** The axes of each joint's link, as columns. */
  rotations: Rotation[][];
  time_s: number[];
  /** The a-priori bodies. */
  bodies: LinkBody[];
}

export type Point = [number, number, number];
/** Three rows. */
export type Rotation = [Point, Point, Point];

/** The homogeneous ellipsoid that has the mass and inertia of a joint's link; null for parameters that no body has. */
export interface LinkBody {
  joint: string;
  body: Ellipsoid | null;
}

export interface Ellipsoid {
  mass: number;
  /** In the frame of the link, m. */
  centre: Point;
  radii: Point;
  /** In the axes of the link, in the order of the radii. */
  axes: [Point, Point, Point];
}

export interface Channel {
  name: string;
  rows: number;
  columns: number;
  smallest: number | null;
  largest: number | null;
  note: string | null;
}

export interface RecordingAnswer {
  path: string;
  text: string;
  format: string;
  samples: number;
  rate_hz: number | null;
  channels: Channel[];
}

/** The columns of a signal, one for each joint that moves. */
export interface Columns {
  columns: string[];
  unit: string | string[];
  side: Side;
}

export interface ProposalAnswer {
  toml: string;
  guesses: string[];
  joints: string[];
  window_s: [number, number];
  rate_hz: number;
  time: string | null;
  position: Columns;
  torque: Columns;
  locked: { name: string; value: number }[];
  /** Torque for 1 A, 1 V or 100 % where it is known. */
  gain: number[];
}

/** The curves of the recording, thinned: one row for each joint. */
export interface Series {
  time_s: number[];
  position: number[][];
  torque: number[][];
  joints: string[];
  position_unit: string | string[];
  torque_unit: string | string[];
  window_s: [number, number];
}

export type Severity = "problem" | "warning" | "note" | "guess";

export interface Finding {
  /** The recording of the finding; undefined for all. */
  recording?: string;
  code: string;
  severity: Severity;
  /** The joint that it concerns. */
  joint: string | null;
  text: string;
  remedy: string | null;
  /** Codes of its remedies that can be applied. */
  apply?: string[];
}

/** A change of the experiment that removes the cause of a finding. */
export interface Remedy {
  code: string;
  label: string;
  found: string;
  changes: { key: string; before: string | null; after: string | null }[];
}

export interface Understanding {
  robot: RobotAnswer | null;
  robot_error: string | null;
  skeleton: Skeleton | null;
  recordings: RecordingAnswer[];
  recording_errors: { path: string; message: string }[];
  proposal: ProposalAnswer | null;
  proposal_error: string | null;
  /** The text of the proposal, if something must be filled in before it can run. */
  unfinished: string | null;
  series: Series | null;
  findings: Finding[];
  remedies: Remedy[];
}

export interface Identified {
  results: { verdict: Verdict | null; robot: string; robot_joints: { name: string }[]; title: string; advice: { recommended: string | null }[]; remedies?: Remedy[] };
  report: string;
  files: Record<string, string>;
  text: string;
  residual: Residual | null;
}

/** Measured minus predicted torques in the first recording, thinned: one row for each joint. */
export interface Residual {
  method: string;
  time_s: number[];
  residual: number[][];
  /** Root mean square of each joint. */
  noise: number[];
}

export type Verdict = "good" | "care" | "do-not-use";

export interface Exported {
  file: string;
  covariance: string | null;
  text: string;
}

/** The samples of the program. */
export type SampleName = "demo" | "arm" | "axis" | "exchanged";

export interface SampleAnswer {
  request: InitRequest;
  /** Where it is not the proposal. */
  experiment: string | null;
}

/** The methods of the session that the page calls. */
export type Method = "put" | "remove" | "kind" | "understand" | "propose" | "identify" | "apply" | "changed" | "sample" | "export" | "bodies" | "urdf";

/** Messages to the worker that holds the session, first the module and then calls, and to each of its threads. */
export type ToWorker =
  | { module: WebAssembly.Module; threads: number }
  | { module: WebAssembly.Module; memory: WebAssembly.Memory }
  | { call: number; method: Method; args: unknown[] };

/** Messages of a worker to the page: its memory if it waits for threads. A trap ends the session: its memory may be in any state. */
export type FromWorker =
  | { memory: WebAssembly.Memory }
  | { call: number; answer: string }
  | { call: number; error: string }
  | { call: number; stage: string }
  | { trap: string };
