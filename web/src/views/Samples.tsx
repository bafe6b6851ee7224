// Recordings to try the page on, and what comes out of the first of them.

import type { SampleName } from "../contract";
import type { View } from "./Page";
import { Preview } from "./Preview";

const SAMPLES: { name: SampleName; title: string; about: string; button: string }[] = [
  { name: "demo", title: "Six joints", about: "A Staubli TX40 with known parameters: how near do the estimates come?", button: "Try the demo" },
  { name: "arm", title: "Three joints", about: "An arm that is described by a URDF, and a log of 12 s.", button: "Try the arm" },
  { name: "axis", title: "One axis", about: "A linear axis with friction, recorded at 1 kHz.", button: "Try the axis" },
  { name: "exchanged", title: "A faulty log", about: "Two torque columns are exchanged: the page finds it, and one button mends it.", button: "Try the faulty log" },
];

/** What is said of the files of a sample. */
export const SAMPLE_NOTES: Record<SampleName, string> = {
  demo: "A simulated Staubli TX40 with known parameters, recorded with noise.",
  arm: "A simulated arm of three joints, recorded with noise.",
  axis: "A simulated linear axis, recorded with noise.",
  exchanged: "A simulated arm of three joints; the names of the first two torques are exchanged in its log.",
};

export function Samples({ state, app }: View) {
  return (
    <div class="samples">
      <h3>Or try a simulated robot</h3>
      <ul class="cards" aria-label="Samples">
        {SAMPLES.map(({ name, title, about, button }) => (
          <li key={name}>
            <strong>{title}</strong>
            <p>{about}</p>
            <button type="button" disabled={state.task !== null} onClick={() => app.sample(name)}>{button}</button>
          </li>
        ))}
      </ul>
      <Preview />
    </div>
  );
}
