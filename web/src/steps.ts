// How far a task is, where the program counts its steps.

export interface Steps {
  done: number;
  of: number;
}

/** The count at the start of a stage, as "3 of 6 estimates, ..."; null where the end is not known. */
export function stepsIn(stage: string): Steps | null {
  const [, done, of] = /^(\d+) of (\d+) /.exec(stage)?.map(Number) ?? [];
  return done !== undefined && of !== undefined && of > 0 ? { done: Math.min(done, of), of } : null;
}
