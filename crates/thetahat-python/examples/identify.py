"""From arrays to parameters with intervals, on a simulated arm whose true parameters are known."""

import thetahat as th


def main() -> None:
    twin = th.testing.twin(seconds=10, seed=1)
    result = th.identify(
        twin.robot,
        twin.recording,
        methods=["idim-ls", "idim-iv"],
        controller=twin.controller,
        cutoff_hz=40,
        decimation=10,
        progress=True,
    )
    print(f"verdict: {result.verdict}")
    for advice in result.advice:
        print(advice)
    for parameter in result["idim-iv"]:
        low, high = parameter.interval_95 or (float("nan"), float("nan"))
        truth = twin.truth[parameter.name]
        print(f"{parameter.name:5} {parameter.estimate:9.4f} {parameter.unit:10} [{low:9.4f}, {high:9.4f}]  true {truth:9.4f}")
    result.report("report.html")


if __name__ == "__main__":
    main()
