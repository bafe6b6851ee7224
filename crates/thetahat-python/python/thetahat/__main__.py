"""The command ``thetahat``, also as ``python -m thetahat``."""

import signal
import sys

from ._thetahat import command


def main() -> int:
    """Run the command with the arguments of the process.

    Returns
    -------
    int
        The exit code: 0 the verdict is good or care; 1 finished, but the verdict is do-not-use; 2 error.
    """
    # Ctrl-C ends the command like any other program.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command(["thetahat", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
