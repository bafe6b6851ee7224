// One list of all that is to be said of the files: the gravest first, each with what to do.

import type { Finding, Severity, Understanding } from "../contract";

const ORDER: Severity[] = ["problem", "warning", "guess", "note"];

export function Findings({ understanding, problem }: { understanding: Understanding; problem: string | null }) {
  const findings = allFindings(understanding, problem);
  if (findings.length === 0) return <p class="fine">Nothing to object to.</p>;
  return (
    <ul class="findings" aria-label="Findings">
      {findings.map((finding, index) => (
        <li key={index} class="finding" data-severity={finding.severity}>
          <span class="severity">{finding.severity}</span>
          <p>{finding.joint && <strong>{finding.joint}: </strong>}{finding.text}{finding.code && <> <span class="code">[{finding.code}]</span></>}</p>
          {finding.remedy && <p class="remedy">{finding.remedy}</p>}
        </li>
      ))}
    </ul>
  );
}

function allFindings({ robot, proposal, proposal_error: failed, findings }: Understanding, problem: string | null): Finding[] {
  const plain = (severity: Severity) => (text: string): Finding => ({ code: "", severity, joint: null, text, remedy: null });
  const all = [
    ...[problem, failed, robot?.problem].filter((text) => text != null).map(plain("problem")),
    ...findings,
    ...(robot?.doubts ?? []).map(plain("warning")),
    ...(proposal?.guesses ?? []).map(plain("guess")),
  ];
  return all.sort((a, b) => ORDER.indexOf(a.severity) - ORDER.indexOf(b.severity));
}
