"""A process that reads what it is given, in bounded memory, and says how that ended."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import resource
import signal
import sys
import traceback
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.errors import Diverged

MEMORY = 4 * 2**30
"""bytes of addresses the process may have; the libraries alone take one and a half GiB."""
SECONDS = 10
"""s of processor time for one input: how busy the machine is does not count."""
WAIT = 600.0
"""s after which a process that takes no processor time waits for ever, as for a pipe."""


class Ended(NamedTuple):
    """How reading ended."""

    how: str
    """`value`, `refused`, or else what went wrong."""
    said: str


class Child:
    """Reads one input after the other; made anew when it died or was stopped."""

    def __init__(self) -> None:
        self._process: multiprocessing.process.BaseProcess | None = None

    def read(self, reader: str, path: Path | str) -> Ended:
        """Have an input read."""
        if self._process is None:
            self._start()
        self._pipe.send((reader, path))
        try:
            if self._pipe.poll(WAIT):
                found: Ended = self._pipe.recv()
                return found
        except EOFError:
            self._process.join()
            code = self._process.exitcode
            ended = Ended("died", f"exit code {code}")
            if code == -signal.SIGXCPU:
                ended = Ended("hung", f"longer than {SECONDS} s")
            self._process = None
            return ended
        self.close()
        return Ended("hung", "waits for something")

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=_serve, args=(other,), daemon=True)
        self._process.start()
        other.close()


def _serve(pipe: Connection) -> None:
    """Read what comes until nobody asks any more."""
    from tests.fuzz.readers import READERS

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: SIM115, what is printed is no matter
    while True:
        try:
            reader, path = pipe.recv()
        except EOFError:
            return
        used = resource.getrusage(resource.RUSAGE_SELF)
        most = int(used.ru_utime + used.ru_stime) + 1 + SECONDS
        resource.setrlimit(resource.RLIMIT_CPU, (most, resource.RLIM_INFINITY))
        pipe.send(_end(READERS[reader].read, path))


def _end(read: object, path: Path | str) -> Ended:
    try:
        read(path)  # type: ignore[operator]
    except (InputError, Diverged) as error:
        said, again = str(error), str(pickle.loads(pickle.dumps(error)))
        fit = said.isprintable() and len(said) < 2000 and said == again
        return Ended("refused" if fit else "refused unfitly", said)
    except BaseException:
        return Ended("raised", traceback.format_exc()[-3000:])
    return Ended("value", "")
