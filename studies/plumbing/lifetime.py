"""When a process ends: by signals that let it clean up, and never later than its parent."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

PR_SET_PDEATHSIG = 1
"""Of Linux's <sys/prctl.h>."""
AGAIN = 10.0
"""s until a signal is told again to code that swallowed it; our choice: cleaning up needs less."""
SAID = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated",
    signal.SIGHUP: "hung up on",
}
"""Signals that end a command, and what it says then."""
LAUNCH = (
    "import ctypes, os, sys\n"
    f"ctypes.CDLL(None).prctl({PR_SET_PDEATHSIG}, {int(signal.SIGKILL)})\n"
    "if os.getppid() == int(sys.argv[1]): os.execvp(sys.argv[2], sys.argv[2:])"
)
"""A program that ties itself to its parent and becomes another."""


class Ended(BaseException):
    """A signal asks the command to end."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(SAID[signal.Signals(number)])


class _Listener:
    """Raises `Ended` in the main thread, but not where that would leave something half done.

    Only the main thread touches it: Python hears signals there alone.
    """

    def __init__(self) -> None:
        self.shields = 0
        """How deep the main thread is in what must not be left half done."""
        self.number: int | None = None
        self.due = False

    def hear(self, number: int, frame: FrameType | None) -> None:
        """The first of several signals counts; an alarm tells it again."""
        if number != signal.SIGALRM:
            self.number = number
            for each in SAID:
                signal.signal(each, signal.SIG_IGN)
        self.due = self.number is not None
        self.tell()

    def tell(self) -> None:
        """Raise once; again only much later: some library's `except:` may have swallowed it."""
        if self.due:
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
            if not self.shields:
                self.due = False
                raise Ended(self.number or 0)


_listener = _Listener()


@contextmanager
def listening() -> Iterator[None]:
    """Within it the signals of `SAID` raise `Ended`; one that is ignored, as by `nohup`, stays so.

    Of the main thread only.
    """
    global _listener
    listener = _listener = _Listener()
    before: dict[signal.Signals, Any] = {number: signal.getsignal(number) for number in SAID}
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, listener.hear)
    hook, sys.unraisablehook = sys.unraisablehook, _unless_ended(sys.unraisablehook)
    for number in SAID:
        if before[number] != signal.SIG_IGN:
            signal.signal(number, listener.hear)
    try:
        yield
    finally:
        deafened()
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = hook


def deafened() -> None:
    """From now on no signal of `SAID` does anything: the command is done, and tidies up."""
    _listener.number, _listener.due = None, False
    for number in SAID:
        signal.signal(number, signal.SIG_IGN)
    signal.setitimer(signal.ITIMER_REAL, 0.0)


def _unless_ended(hook: Callable[[Any], Any]) -> Callable[[Any], None]:
    """Where Python cannot raise `Ended`, it is told again later, and nobody needs to see it."""

    def seen(raised: Any) -> None:
        if not isinstance(raised.exc_value, Ended):
            hook(raised)

    return seen


@contextmanager
def shielded() -> Iterator[None]:
    """A signal that arrives within it is told at its end: for what must not be left half done.

    No signal interrupts a thread other than the main one: there it does nothing, and keeps nobody
    waiting.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    listener = _listener
    listener.shields += 1
    try:
        yield
    finally:
        listener.shields -= 1
        listener.tell()


TERMINAL = (signal.SIGINT, signal.SIGHUP)
"""Signals that a terminal sends to everybody: they are the command's to answer."""


@contextmanager
def deaf() -> Iterator[None]:
    """Processes started within it hear nothing of `TERMINAL`, until they unblock it themselves.

    A fresh interpreter has no handler while it is loaded: an interrupt would end it in a traceback.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, TERMINAL)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with(parent: int) -> None:
    """Let the kernel kill this process as soon as `parent` is gone, however it goes.

    What counts is the parent's thread that started this process: it must last as long.

    Args:
        parent: The parent's process id, as the parent knows it.
    """
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it went before the kernel was told
        os._exit(1)


def tied(command: tuple[str, ...]) -> list[str]:
    """The command that does the same and ends with this process; same process id, same output."""
    return [sys.executable, "-I", "-S", "-c", LAUNCH, str(os.getpid()), *command]
