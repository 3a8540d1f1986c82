"""`realitygap` as it is started: ready to be interrupted before anything has been imported."""

from __future__ import annotations

import signal


def main() -> None:
    """Run the command line. An interrupt before it listens finds nothing to clean up."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from realitygap.studies.cli import main as run

    run()


if __name__ == "__main__":
    main()
