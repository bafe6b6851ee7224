// The result of the demo, which `web/build` makes and stores in the page: what a visitor can expect, without a click.

import { interval, significant } from "../words";

/** An estimate next to the value with which the robot was simulated. */
export interface PreviewValue {
  name: string;
  unit: string;
  estimate: number;
  /** Half of the 95 % interval. */
  half: number;
  known: number;
}

export interface DemoResult {
  verdict: string;
  method: string;
  /** Error of the torques, and on data that were not used, percent. */
  error: number;
  unseen: number | null;
  values: PreviewValue[];
}

/** Set by esbuild; null where the page was built without it. */
declare const DEMO_RESULT: DemoResult | null;

/** Parameters in the table. */
const SHOWN = 8;
const WIDTH = 150;
const HEIGHT = 16;
/** Half the width of a picture in half intervals. */
const SPAN = 2;

export function Preview() {
  if (!DEMO_RESULT) return null;
  const { verdict, method, error, unseen, values } = DEMO_RESULT;
  const within = values.filter(({ estimate, half, known }) => Math.abs(estimate - known) <= half).length;
  return (
    <figure class="preview">
      <figcaption>
        <strong>The result of the demo: {verdict}.</strong>{" "}
        {method.toUpperCase()} leaves {error.toPrecision(2)} % of the torques{unseen !== null && `, and ${unseen.toPrecision(2)} % on motion that was not used`}.{" "}
        {within} of {values.length} known values lie in the 95 % intervals of the estimates. The first {SHOWN}:
      </figcaption>
      <div class="scroll" tabIndex={0} role="region" aria-label="The result of the demo">
        <table>
          <thead><tr><th class="lead">parameter</th><th>known</th><th>estimated</th><th class="lead">unit</th><th class="lead">interval around the known value</th></tr></thead>
          <tbody>{values.slice(0, SHOWN).map((value) => <Row key={value.name} value={value} />)}</tbody>
        </table>
      </div>
    </figure>
  );
}

function Row({ value }: { value: PreviewValue }) {
  const { name, unit, estimate, half, known } = value;
  return (
    <tr>
      <th class="lead" scope="row">{name}</th>
      <td>{significant(known)}</td>
      <td>{interval(estimate, half)}</td>
      <td class="lead">{unit}</td>
      <td class="lead"><Interval value={value} /></td>
    </tr>
  );
}

/** The interval of an estimate as a bar, with the known value as a line in the middle. */
function Interval({ value: { estimate, half, known } }: { value: PreviewValue }) {
  const x = (at: number) => WIDTH * (0.5 + (at - known) / half / (2 * SPAN));
  return (
    <svg class="interval" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} width={WIDTH} height={HEIGHT} aria-hidden="true">
      <path class="known" d={`M${WIDTH / 2} 0V${HEIGHT}`} />
      <path class="bar" d={`M${x(estimate - half).toFixed(1)} ${HEIGHT / 2}H${x(estimate + half).toFixed(1)}`} />
      <circle class="dot" cx={x(estimate).toFixed(1)} cy={HEIGHT / 2} r="3" />
    </svg>
  );
}
