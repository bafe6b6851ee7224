// One list of all findings in the files: the most serious first, each with its remedy.

import { isOwnText } from "../state";
import { sentence } from "../words";
import type { Finding, RobotAnswer, Severity, Understanding } from "../contract";
import type { View } from "./Page";
import { RemedyButton } from "./Remedies";

/** The code of doubtful values in a robot's description. */
const DOUBT = "robot-description";
const ORDER: Severity[] = ["problem", "warning", "guess", "note"];

export function Findings({ state, app, understanding, problem }: View & { understanding: Understanding; problem: string | null }) {
  const findings = allFindings(understanding, problem);
  if (findings.length === 0) return isRead(understanding) ? <p class="fine">No problems found.</p> : null;
  const isOfSeveral = new Set(understanding.findings.map(({ recording }) => recording)).size > 1;
  return (
    <ul class="findings" aria-label="Findings">
      {findings.map((finding, index) => (
        <li key={index} class="finding" data-severity={finding.severity}>
          <span class="severity">{finding.severity}{isOfSeveral && finding.recording && ` (${finding.recording})`}</span>
          <p>{finding.joint && <strong>{finding.joint}: </strong>}{finding.text}{finding.code && <> <span class="code">[{finding.code}]</span></>}</p>
          {finding.remedy && <p class="remedy">{finding.remedy}</p>}
          {!isOwnText(state.experiment) && understanding.remedies.filter(({ code }) => finding.apply?.includes(code)).map((remedy) => (
            <RemedyButton key={remedy.code} state={state} app={app} remedies={understanding.remedies} remedy={remedy} />
          ))}
        </li>
      ))}
    </ul>
  );
}

/** Whether all files were read and checked: without that, no finding says nothing. */
function isRead({ robot_error: failed, recording_errors: errors, proposal }: Understanding): boolean {
  return failed === null && errors.length === 0 && proposal !== null;
}

function allFindings({ robot, proposal, proposal_error: failed, findings }: Understanding, problem: string | null): Finding[] {
  const problems = [problem, failed, robot?.problem].filter((text) => text != null).map(plain("problem"));
  const guesses = (proposal?.guesses ?? []).map(sentence).map(plain("guess"));
  // The checks of a log also report doubtful values of the robot.
  const doubts = findings.some(({ code }) => code === DOUBT) ? [] : (robot?.doubts ?? []).map(doubtful);
  return [...problems, ...findings, ...doubts, ...guesses].sort((a, b) => ORDER.indexOf(a.severity) - ORDER.indexOf(b.severity));
}

function plain(severity: Severity): (text: string) => Finding {
  return (text) => ({ code: "", severity, joint: null, text, remedy: null });
}

function doubtful({ place, what, remedy }: RobotAnswer["doubts"][number]): Finding {
  return { code: DOUBT, severity: "warning", joint: null, text: `${place}: ${what}`, remedy };
}
