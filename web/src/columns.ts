// The columns of each joint, as a table that the user edits.

import type { RecordingAnswer, Understanding } from "./contract";
import type { Choices } from "./state";

export interface JointColumns {
  name: string;
  /** Empty if unknown. */
  position: string;
  torque: string;
  /** The value at which it is locked, rad or m; null if it moves. */
  locked: number | null;
}

export interface Assignment {
  /** Empty without a time column. */
  time: string;
  joints: JointColumns[];
}

/** The names of all columns, those of a matrix one by one: `q[1]`. */
export function columnNames(recordings: RecordingAnswer[]): string[] {
  const names = recordings.flatMap(({ channels }) => channels).flatMap(({ name, columns }) =>
    columns === 1 ? [name] : Array.from({ length: columns }, (_, index) => `${name}[${index + 1}]`));
  return [...new Set(names)];
}

/** The proposal; unknown columns are empty. */
export function assignmentOf({ robot, proposal }: Understanding): Assignment {
  const locks = new Map((proposal?.locked ?? robot?.locked ?? []).map(({ name, value }) => [name, value]));
  const moving = (robot?.joints ?? []).filter(({ coordinate }) => coordinate !== null).map(({ name }) => name).filter((name) => !locks.has(name));
  const order = proposal?.joints ?? moving;
  const column = (columns: string[] | undefined, name: string) => columns?.[order.indexOf(name)] ?? "";
  const joints = [...moving, ...locks.keys()].map((name) => ({
    name,
    position: column(proposal?.position.columns, name),
    torque: column(proposal?.torque.columns, name),
    locked: locks.get(name) ?? null,
  }));
  return { time: proposal?.time ?? "", joints };
}

/** The corresponding choices; null if a joint that moves has no column. */
export function choicesOf({ time, joints }: Assignment): Choices | null {
  const moving = joints.filter(({ locked }) => locked === null);
  if (moving.some(({ position, torque }) => position === "" || torque === "")) return null;
  const locked = joints.filter(({ locked }) => locked !== null).map(({ name, locked }) => [name, locked as number]);
  return {
    joints: moving.map(({ name }) => name),
    position: moving.map(({ position }) => position),
    torque: moving.map(({ torque }) => torque),
    locked: Object.fromEntries(locked),
    ...(time === "" ? {} : { time }),
  };
}
