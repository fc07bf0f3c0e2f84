"""The program ``servoid``: ``python -m servoid``."""

import signal
import sys

from ._servoid import run_program


def main() -> int:
    """Run the program with the arguments of this process.

    Returns
    -------
    int
        The exit code: 0, 1 for a failure, 2 for wrong usage, 3 for a partial recording.
    """
    # The interpreter only notes Ctrl-C and acts on it later; a program ends by it, or catches it itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_program(["servoid", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
