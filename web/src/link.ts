// Links to the page with settings in the fragment, which browsers send to no server: a sample, choices, the text of an experiment. No data.

import type { SampleName } from "./contract";
import { isOwnText, type Choices, type State } from "./state";

export const SAMPLES: SampleName[] = ["demo", "arm", "axis", "exchanged"];

export interface Linked {
  sample: SampleName | null;
  choices: Choices;
  /** The user's own text. */
  experiment: string | null;
}

const isText = (value: unknown) => typeof value === "string";
const isNumber = (value: unknown) => typeof value === "number" && Number.isFinite(value);
const isListOf = (isOne: (value: unknown) => boolean) => (value: unknown) => Array.isArray(value) && value.every(isOne);
const isLocks = (value: unknown) => typeof value === "object" && value !== null && !Array.isArray(value) && Object.values(value).every(isNumber);

/** What each choice must be. */
const CHOICES: { [key in keyof Required<Choices>]: (value: unknown) => boolean } = {
  position: isListOf(isText),
  torque: isListOf(isText),
  time: isText,
  joints: isListOf(isText),
  rate: isNumber,
  position_unit: isText,
  torque_unit: isText,
  side: isText,
  window_s: (value) => isListOf(isNumber)(value) && (value as number[]).length === 2,
  locked: isLocks,
  gain: isListOf(isNumber),
  position_gain: isListOf(isNumber),
  velocity_gain: isListOf(isNumber),
  methods: isListOf(isText),
};

/** The link to a page with this state's settings. */
export function linkOf({ sample, choices, experiment }: State, page: string): string {
  const parts = new URLSearchParams();
  if (sample) parts.set("sample", sample);
  if (Object.keys(choices).length > 0) parts.set("settings", JSON.stringify(choices));
  if (experiment && isOwnText(experiment)) parts.set("experiment", experiment.text);
  return `${page.split("#")[0]}#${parts}`;
}

/** What a fragment holds: null without settings, a sentence where they cannot be used. */
export function linkedIn(fragment: string): Linked | string | null {
  const parts = new URLSearchParams(fragment.replace(/^#/, ""));
  const [sample, settings, experiment] = ["sample", "settings", "experiment"].map((name) => parts.get(name));
  if (sample == null && settings == null && experiment == null) return null;
  if (sample != null && !SAMPLES.includes(sample as SampleName)) return `The link names a sample that this page does not have: ${sample}. The samples are ${SAMPLES.join(", ")}.`;
  const choices = choicesIn(settings ?? "{}");
  if (!choices) return "The settings of the link cannot be read: it may have been cut. Copy it again as a whole.";
  return { sample: (sample ?? null) as SampleName | null, choices, experiment: experiment ?? null };
}

function choicesIn(text: string): Choices | null {
  try {
    const found: unknown = JSON.parse(text);
    if (typeof found !== "object" || found === null) return null;
    const isKnown = ([key, value]: [string, unknown]) => Object.hasOwn(CHOICES, key) && CHOICES[key as keyof Choices](value);
    const entries = Object.entries(found);
    return entries.every(isKnown) ? (Object.fromEntries(entries) as Choices) : null;
  } catch {
    return null;
  }
}
