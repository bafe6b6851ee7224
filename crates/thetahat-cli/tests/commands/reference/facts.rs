//! What the sources do not say in a form that can be read: what each code demands.
//! `{file NAME}` stands for the constant of that name in that file.

/// How the value of a type is named that has its own table, or that is read by hand.
pub fn named(of: &str) -> Option<&'static str> {
    Some(match of {
        "f64" => "number",
        "u8" | "u32" | "u64" | "usize" => "whole number",
        "bool" => "`true` or `false`",
        "String" | "EstimatedSize" => "text",
        "char" => "character",
        "PathBuf" => "path",
        "Unit" => "[unit](recordings.md#units)",
        "Method" => "[method](experiments.md#methods)",
        "Code" => "[code](checks.md#codes)",
        "ReasonCode" => "[code](verdict.md#reasons)",
        "Verdict" => "[verdict](verdict.md#verdicts)",
        "Status" => "[status](results.md#statuses)",
        "IgnoredAny" => "text",
        _ => return None,
    })
}

/// Structs whose fields have the doc comments of a struct that is read in their place.
pub fn same_keys(of: &str) -> &'static [&'static str] {
    match of {
        "Tables" => &["ExperimentFile", "Settings", "Locks"],
        "RobotFile" => &["Locks"],
        _ => &[],
    }
}

/// The ten parameters of a link, which the paper names and no doc comment explains.
pub const LINK_QUANTITIES: [(&str, &str); 3] = [
    ("xx xy xz yy yz zz", "Inertia about the origin of the link's frame, along its axes."),
    ("mx my mz", "First moments: mass times centre of mass."),
    ("m", "Mass."),
];

/// Code, severities, evidence, and what to do.
pub const FINDINGS: [[&str; 4]; 46] = [
    [
        "position-scale",
        "problem, warning",
        "ratio for positions in another unit or from the other side of the gears ({checks/torque/hypotheses COMMON_LIMIT} for all joints or units of several, {checks/torque/hypotheses SINGLE_LIMIT} for one); or the span of a joint over the range that its description allows ({checks/motion/position_range LIMIT}); a warning where joints hardly turn in degrees and may be in rad (`unit_guessed`)",
        "correct `unit` or `side` of the position, or the ratios in `[transmission]`",
    ],
    [
        "position-sign",
        "problem",
        "ratio for the other sign ({checks/torque/hypotheses SINGLE_LIMIT}; {checks/torque/hypotheses MANY_LIMIT} for position and torque together); or the power of friction, in standard deviations below zero ({checks/torque/friction NEGATIVE_LIMIT})",
        "a negative `gain` of the position, or the motor's row of the transmission matrix",
    ],
    [
        "position-zero",
        "problem, warning",
        "ratio for the transmission's offsets added or subtracted ({checks/torque/hypotheses COMMON_LIMIT}); a warning where the middle of a joint's motion lies outside its limits by more than {checks/motion/position_range BEYOND} of its span",
        "check `offset_deg`, and whether the positions include it already",
    ],
    [
        "torque-scale",
        "problem, warning",
        "ratio for torques from the other side of the gears ({checks/torque/hypotheses COMMON_LIMIT} for all joints, {checks/torque/hypotheses SINGLE_LIMIT} for one); a warning where the unit is a guess (`unit_guessed`): from the description's masses, or where the log does not say it and the description has none",
        "correct `side` of the torque, or the ratios in `[transmission]`",
    ],
    [
        "torque-sign",
        "problem",
        "ratio for the other sign ({checks/torque/hypotheses SINGLE_LIMIT}); or the power of friction, in standard deviations below zero ({checks/torque/friction NEGATIVE_LIMIT})",
        "a negative `gain` of the torque, or the motor's row of the transmission matrix",
    ],
    [
        "joints-swapped",
        "problem, warning",
        "ratio for positions, torques or both of two joints exchanged ({checks/torque/hypotheses MANY_LIMIT}), or in any other order ({checks/torque/hypotheses ORDER_LIMIT}); for two joints that are alike, such as those of a wrist, deviations by which the likelihood is larger with both exchanged ({checks/torque/alike LIKELY}; a problem from {checks/torque/alike CERTAIN})",
        "exchange the columns in the experiment file",
    ],
    [
        "gear-ratio",
        "problem",
        "rms torque that another ratio of a motor, or another scale of a position or torque, explains ({checks/torque/gear EFFECT_LIMIT_PERCENT} % of the torques; the scale differs from one by {checks/torque/gear SIGNIFICANT} standard deviations)",
        "check the ratio, the position's scale or the drive's gain that the message names",
    ],
    [
        "lag",
        "problem, warning, note",
        "samples by which torques are later than positions. A warning where it explains {checks/time/lag EXPLAINED_LIMIT_PERCENT} % of the squared residual and {checks/time/lag EFFECT_LIMIT_PERCENT} % of the torque, or {checks/time/lag MOST_OF_RESIDUAL_PERCENT} % of the squared residual, or where it is that of a held torque (half a sample early); else a note. A problem where nothing else explains the torques and a lag of {checks/time/lag_search LONGEST_S} to {checks/time/long_lag LONGEST_S} s reduces the squared residual by {checks/time/long_lag GAIN} times",
        "`held = true` for a torque that the controller holds from sample to sample, or `delay_s` of the torque",
    ],
    [
        "dropped-samples",
        "warning, note",
        "samples that are missing, by time stamps, or by jumps of all joints that are as long as their velocities say. A note where time stamps show them and at most {checks/time/stamps FEW_MISSING_PERCENT} % are missing",
        "record again with a logger that keeps up; rows in and around gaps are left out",
    ],
    [
        "repeated-samples",
        "warning",
        "moving samples at which all positions, or all torques, repeat the sample before exactly ({checks/motion/repeats REPEATED_LIMIT_PERCENT} %)",
        "log at the rate at which values are new, or take the rows out that repeat them; positions that are repeated regularly are interpolated in reading",
    ],
    [
        "clock-jitter",
        "warning, note",
        "rms deviation of the time steps ({checks/time/stamps JITTER_LIMIT_PERCENT} % of a step). A note where the positions are smooth on their stamps",
        "where the positions are smooth on equal steps, state `sample_rate_hz` in place of `time`",
    ],
    [
        "rate-contradicted",
        "problem",
        "deviation of the stated `sample_rate_hz` from the rate of the times in the file ({checks/time/stamps RATE_LIMIT_PERCENT} %)",
        "name that column as `time`",
    ],
    [
        "time-scale",
        "problem, warning",
        "ratio for times that are longer or shorter by one factor ({checks/torque/clock LIMIT}), at least {checks/torque/clock LEAST} from one; a problem beyond {checks/torque/clock WRONG} or {checks/torque/gravity_fit WRONG_RATIO} times",
        "`sample_rate_hz`, or the unit of the time; the message says which rate fits",
    ],
    [
        "torque-saturated",
        "problem, warning",
        "samples of a drive at exactly its extreme value, many more than at the next value ({checks/torque/levels SATURATED_LIMIT_PERCENT} % of the window); a problem: rows at its extreme value where the motion, by a fit to the other times, asks for more, which the torque does not follow ({checks/torque/limit LIMIT_PERCENT} % of the window)",
        "move more slowly, widen the range of drive or logger, or leave the times out by `left_out_s`",
    ],
    [
        "torque-constant",
        "problem, note",
        "a torque that never changes; a note where no parameter depends on it, or the motion shows that nothing drives the joint",
        "check the torque's column",
    ],
    [
        "torque-copied",
        "problem",
        "a torque that is a multiple of another joint's at every sample, to 1e-7 of its span",
        "check the torque columns of both joints",
    ],
    [
        "torque-quantised",
        "warning",
        "error of the torque's steps over its standard deviation ({checks/torque/levels STEP_LIMIT_PERCENT} %); or few different values",
        "record more digits, or a finer range of the current",
    ],
    [
        "torque-spikes",
        "warning, note",
        "samples more than {checks/torque/spikes OUTLYING} robust standard deviations from the median of five. A note where they are more than 1 % of the samples and of one size, as a velocity loop makes them from the steps of an encoder",
        "replace them by the mean of their neighbours; look for the loose contact",
    ],
    [
        "position-quantised",
        "warning, note",
        "noise of the acceleration, after a suitable filter and the decimation, that the position's steps cause ({checks/motion/resolution STEP_LIMIT_PERCENT} %). A note where it moves no estimate of the model by a tenth of its interval",
        "record the encoder's own counts, or lower `cutoff_hz`",
    ],
    ["position-spikes", "warning, note", "as `torque-spikes`", "as `torque-spikes`"],
    [
        "position-jump",
        "problem, warning",
        "a step of a position that stays, {checks/motion/jumps TIMES} times the steps around it, percent of the joint's span ({checks/motion/jumps FOUND_PERCENT} %). A problem above {checks/motion/jumps USABLE_PERCENT} %",
        "cut the file there and run `thetahat init` with one part, or with both where most joints jump",
    ],
    [
        "velocity-mismatch",
        "warning, note",
        "rms difference of the recorded velocity and the derivative of the position ({checks/motion/velocity LIMIT_PERCENT} %). A note where no gain, sign, other joint or lag explains most of it",
        "check the velocity's column, unit and sign; estimates use the position only",
    ],
    [
        "joint-still",
        "problem, note",
        "a velocity that stays below {checks/signals STILL} rad/s or m/s",
        "move the joint, or exclude its parameters",
    ],
    [
        "still-period",
        "warning, note",
        "part of the window in which no joint moves for {checks/motion/still REST_PERIODS} periods of the cut-off ({checks/motion/still REST_LIMIT_PERCENT} %). A note where `mask` leaves it out",
        "`mask = \"near-rest\"`, or a window without the rests",
    ],
    [
        "cutoff-low",
        "warning",
        "rms torque that twice the cut-off explains and the cut-off does not, on stretches that were not fitted, without the rests of joints that stand most of the time ({checks/time/cutoff LIMIT_PERCENT} %, and a squared error {checks/time/cutoff WORTH_IT} times as large)",
        "raise `cutoff_hz` to the value in the message, which was tried",
    ],
    [
        "cutoff-high",
        "warning",
        "part of the acceleration, after filter and decimation, that is white noise of the position ({checks/motion/resolution NOISE_LIMIT_PERCENT} %)",
        "lower `cutoff_hz` to about five times the motion's bandwidth",
    ],
    [
        "negative-friction",
        "problem",
        "power of friction that drives the joint, in standard deviations ({checks/torque/friction NEGATIVE_LIMIT}), and no change of sign explains it",
        "check signs, and whether position and torque belong to the same joint",
    ],
    [
        "poor-fit",
        "warning",
        "what the model with its best parameters leaves of all torques ({checks/torque/friction WHOLE_LIMIT_PERCENT} %) or of one joint's ({checks/torque/friction JOINT_LIMIT_PERCENT} %)",
        "fix the other findings first; then geometry, order of the joints, loads",
    ],
    [
        "not-excited",
        "warning, note",
        "a warning: parameters that others span exactly, which `identify` leaves out, or variance inflation above {checks/motion/excitation INFLATION_LIMIT}. A note: estimates with a relative standard deviation above {run/validation/uncertain LIMIT_PERCENT} %",
        "move the joints faster and in other configurations, or leave parameters out: `exclude` or `estimate = \"essential\"` in `[parameters]`",
    ],
    [
        "reference-mismatch",
        "warning",
        "rms deviation of the motion from its reference ({checks/control/reference LIMIT_PERCENT} % of the motion)",
        "check column, unit and side of the reference; the message has a `reference_correction` where one helps",
    ],
    [
        "controller-mismatch",
        "warning",
        "part of the drive signals that the described controller does not give for the recorded reference and motion ({checks/control/controller LIMIT_PERCENT} %). A constant factor is named with the gear ratio that it is near",
        "check law, gains and delay of `[controller]`; gains are in joint units",
    ],
    [
        "torque-idle",
        "problem, warning",
        "moving samples at which the drive's signal is one value ({checks/motion/levels IDLE_LIMIT_PERCENT} %; a problem above {checks/motion/levels LOST_PERCENT} %), or a stretch of {checks/motion/levels FEWEST_FROZEN} samples or more without a change, in which the joint moves ({checks/motion/levels FROZEN_LIMIT_PERCENT} % of the window)",
        "record the torque at every sample",
    ],
    [
        "torque-noise",
        "problem",
        "what the model leaves of a joint's torque, per degree of freedom ({checks/torque/unexplained LIMIT_PERCENT} %), where neighbouring rows of it do not agree",
        "check the torque's column, scale and digits",
    ],
    [
        "joint-dither",
        "problem, note",
        "a joint that spans less than {checks/motion/dither SMALLEST_RAD} rad or {checks/motion/dither SMALLEST_M} m at velocities of a moving joint",
        "move it, or exclude its parameters",
    ],
    [
        "a-priori-scale",
        "problem, warning",
        "factor between the torques and those of the description's masses, of the same form ({checks/robot/a_priori LIMIT}, up or down); a problem where several joints have it, or one where two others agree with the masses",
        "correct `side`, `unit` or `gain` of the torque",
    ],
    [
        "worse-than-mean",
        "problem, warning",
        "as `torque-noise`, where neighbouring rows agree. Of a run: joints with an error above {run/validation/no_predictive_power LIMIT_PERCENT} %; a warning on recordings that are held back",
        "check that the column is this joint's torque and belongs to this motion",
    ],
    [
        "wrong-robot",
        "problem, warning",
        "error of the robot's model over that of independent single-joint models ({checks/robot/wrong_robot LIMIT_PERCENT} %; a problem above {checks/robot/wrong_robot WRONG_PERCENT} %)",
        "check that the description is of this robot, and the order of the columns",
    ],
    [
        "gravity-direction",
        "problem, warning",
        "ratio for gravity of the same length from another direction ({checks/torque/gravity_fit LIMIT}), at least {checks/torque/gravity LEAST_DEG} degrees from the stated one; a problem beyond {checks/torque/gravity WRONG_DEG} degrees ({checks/torque/gravity WRONG_LIMIT}) or {checks/torque/gravity_fit WRONG_RATIO} times. A problem: ratio for torques without gravity, or less than {checks/torque/weight LEAST_WEIGHT} of the weight of the description's links, which would make the squared residual {checks/torque/gravity_fit WRONG_RATIO} times larger",
        "`gravity` of the experiment, as in the message",
    ],
    [
        "gain-drift",
        "warning",
        "change of a joint's torque over the recording ({checks/time/drift GAIN_LIMIT_PERCENT} %, and {checks/time/drift SIGNIFICANT_GAIN} standard deviations)",
        "check drive gain and payload; compare shorter windows",
    ],
    [
        "friction-drift",
        "warning",
        "change of a joint's friction over the recording ({checks/time/drift FRICTION_LIMIT_PERCENT} %, and {checks/time/drift SIGNIFICANT_FRICTION} standard deviations), in a joint that moves in a quarter of it; a note where the model errs by at most {run/explained_by_model SHOWS_DRIFTS_PERCENT} % and shows none",
        "warm the joint up, or start the window later",
    ],
    [
        "same-recording",
        "problem",
        "moving samples that two recordings share, position and torque of every joint ({checks/recordings/same_recording LIMIT_PERCENT} %)",
        "remove one, or give them windows that do not overlap",
    ],
    [
        "recordings-contradict",
        "problem, warning",
        "residual of the common fit over those of separate fits ({checks/recordings/contradiction LIMIT}); a warning for a recording that is held back",
        "look for another payload, tool, zero or temperature; identify that recording separately",
    ],
    [
        "not-physical",
        "problem, warning, note",
        "of a run's estimates: standard deviations by which they are physically inconsistent, or the upper end of the interval of a motor inertia or friction coefficient that is negative",
        "`physical = true`; `fix` for a motor inertia; record faster changes of velocity",
    ],
    [
        "robot-description",
        "warning",
        "of the URDF: negative masses, damping or friction, physically impossible inertias; they are used as they are",
        "correct the description",
    ],
    [
        "equations-used",
        "note",
        "a robot on a base that floats: the part of the window in which the six equations of the base, and those of the joints, are used",
        "nothing to do; measured forces, torques and times without contact give more equations",
    ],
    [
        "external-force",
        "problem",
        "mean squared residual over that of the fit without the times at which the joints' errors are {checks/torque/external_force HIGH} times the usual ones for {checks/torque/external_force SHORTEST_S} s or longer ({checks/torque/external_force GAIN} times)",
        "record without contacts and pushes, or leave the times out by `left_out_s`",
    ],
];

/// Code, what asks for care, what forbids the use, and what to do.
pub const REASONS: [[&str; 4]; 18] = [
    ["check-problem", "", "a problem of the checks in a recording that was used", "that of the finding"],
    [
        "drive-gain",
        "",
        "a known payload gives a torque a factor whose interval excludes one, and which differs from one by more than {results/payload OF_FRICTION}, or by more than {results/payload SMALLEST} where recordings contradict each other",
        "correct the drive's gain, or the payload's mass",
    ],
    [
        "recordings-disagree",
        "`recordings-contradict` is a warning: a recording that is held back differs",
        "`recordings-contradict` is a problem",
        "identify the recording that differs separately",
    ],
    [
        "not-converged",
        "without a model: a nominal run did not converge, and the advice takes another method",
        "without a model: the advice takes none",
        "leave the method out, or read its reason",
    ],
    ["undecided", "", "without a model: the advice takes no method", "`held = true`, or a wider `mask`; compare again"],
    [
        "nothing-explained",
        "",
        "the model leaves more than {diagnosis/verdict/model TOO_LITTLE_PERCENT} % of the torques of unseen motion; without a model: no joint is explained better than by a constant",
        "check that the torques belong to this motion and this robot",
    ],
    [
        "joint-not-explained",
        "the model leaves more than {diagnosis/verdict/model UNEXPLAINED_PERCENT} % of a torque that is small against the others",
        "the same of a torque that is not; without a model: a joint is explained no better than by a constant (p above {results/diagnosis LIMIT}), or predicted worse than by zero",
        "check the joint's torque column; record longer where rows are too few",
    ],
    [
        "lag",
        "a finding `lag` of {diagnosis/verdict/recordings ONE_SAMPLE} sample or more",
        "",
        "`delay_s` of the torque",
    ],
    ["check-warning", "any other warning in a recording that was used", "", "that of the finding"],
    [
        "cross-validation",
        "the model's error on unseen motion above {diagnosis/verdict/model FAR_FROM_FIT} times that of its fit, and above {diagnosis/verdict/model STRUCTURE_PERCENT} % of the torques; without a model: above {diagnosis/verdict/estimates CROSS_VALIDATION} times",
        "without a model: above {diagnosis/verdict/estimates CROSS_VALIDATION_FAR} times; or above {diagnosis/verdict/estimates CROSS_VALIDATION} times and {diagnosis/verdict/estimates USELESS_PERCENT} % of the torque",
        "`estimate = \"essential\"` in `[parameters]`, or record more motion",
    ],
    [
        "joint-poorly-explained",
        "a joint keeps more than {diagnosis/verdict/model POORLY_PERCENT} % of its torque",
        "",
        "look at the joint's residual in the report",
    ],
    [
        "not-physical",
        "without a model: links are inconsistent by more than noise explains; or a motor inertia or friction coefficient has an interval below zero",
        "without a model: the latter significant after Bonferroni correction at {run/physical/not_physical CHANCE}, where the joint's residual is noise",
        "that of the finding",
    ],
    [
        "last-resort",
        "without a model: only a method that fits the simulated loop can be taken",
        "",
        "compare with a second recording, or record torques for `idim-iv`",
    ],
    [
        "correlated-residual",
        "what neighbouring rows predict of the model's residual is above {diagnosis/verdict/model STRUCTURE_PERCENT} % of the torques, or errors at the rate of the samples that last for {run/model/lasting OF_MOTION} of the motion's period above {diagnosis/verdict/model LASTING_PERCENT} %, or torques that look early at reversals explain more than {results/cause EARLY_PERCENT} %, and no cause is named; without a model: neighbouring rows of a joint's residual correlate by more than {diagnosis/verdict/estimates WHITE} plus {diagnosis/verdict/estimates MORE_DEVIATIONS} / sqrt(rows)",
        "",
        "`compare_terms = true`; look at the residual over velocity, position and load",
    ],
    [
        "influence",
        "without a model: an estimate changes by more than {diagnosis/verdict/estimates INFLUENCE} standard deviations without one part of the data",
        "",
        "look at that part, and record more like it",
    ],
    [
        "few-rows",
        "fewer than {diagnosis/verdict/recordings FEWEST_ROWS} rows for each parameter",
        "",
        "record longer, or lower `decimation`",
    ],
    [
        "cause",
        "a [cause](../manual/what_you_get.md#what-the-model-can-be-wrong-in) has a probability below 1e-5 by chance (of n > 300 rows for each joint: below its power sqrt(n / 300); of encoder zeros, gear ratios and lengths below 1e-4, of n > 500 rows below its power n / 500) and explains more than {run/model/causes/mod LEAST_ERROR_PERCENT} % of the torques; a delay counts from {diagnosis/verdict/model LATE_SAMPLES} samples and {diagnosis/verdict/model LATE_S} s",
        "a payload that is picked up or put down explains more than {diagnosis/verdict/model PAYLOAD_PERCENT} % of the torques",
        "that of the cause",
    ],
    [
        "changed-file",
        "`results.json` has another digest than it states",
        "",
        "identify again, or take the file that thetahat wrote",
    ],
];
