"""Where work runs: `concurrent.futures` executors, on this machine's cores or on a Dask cluster.

Work is a module-level function of one picklable task that returns its result by value, so that a
worker needs no disk in common with its caller, and a task that ran twice does no harm.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import sys
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    as_completed,
)
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, Generic, TypeAlias, TypeVar
from urllib.parse import urlsplit

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.plumbing.lifetime import TERMINAL, deaf, end_with, shielded
from realitygap.studies.plumbing.rooms import command_room

Task = TypeVar("Task")
Result = TypeVar("Result")
Answer: TypeAlias = tuple[Result | None, str | None, float]
"""A worker's: value or error, s of processor time."""

FRUITLESS = 3
"""Worker pools that may die one after another without finishing a task; our choice: one that kills
its worker every time is a fault of the work, not of the machine."""
TRACKED = "ignore:resource_tracker"
"""Of Python's `-W`. When a command is killed, multiprocessing's tracker clears its semaphores away;
that it does so is no news for the terminal."""
CONNECT_SECONDS = 10.0
"""s to wait for a scheduler's answer; our choice."""
KNOCK_SECONDS = 0.2
"""s between two tries at one that is just starting; our choice."""


class Unfinished(RuntimeError):
    """Work ended before it was whole: what is finished is kept, and doing it again goes on."""


class WorkersLost(Unfinished):
    """Workers keep dying."""


@dataclass(frozen=True)
class Finished(Generic[Task, Result]):
    """A task and how it ended."""

    task: Task
    value: Result | None
    error: str | None
    """What the work raised, as text: not every exception can be sent; then there is no value."""
    cpu_seconds: float
    """s of processor time that the worker spent."""
    workers: int
    """How many tasks run side by side."""


@dataclass(frozen=True)
class Workers:
    """Which executor: local processes, or the workers of a Dask scheduler."""

    jobs: int
    """Local processes; unused with a scheduler."""
    scheduler: str | None = None
    """`tls://host:port` or `tcp://host:port` of a Dask scheduler (extra `[cluster]`)."""

    @classmethod
    def chosen(cls, jobs: int | None, scheduler: str | None) -> Workers:
        """From the command line: all cores unless told.

        Raises:
            InputError: no jobs, or both jobs and a scheduler.
        """
        if jobs is not None and jobs < 1:
            raise InputError("--jobs", jobs, "at least 1")
        if scheduler is not None and jobs is not None:
            raise InputError("--jobs", jobs, "--jobs or --scheduler, not both")
        if scheduler is not None and "://" not in scheduler:
            raise InputError("--scheduler", scheduler, "an address like tls://host:8786")
        return cls(len(os.sched_getaffinity(0)) if jobs is None else jobs, scheduler)

    @contextmanager
    def open(self, tasks: int) -> Iterator[tuple[Executor, int]]:
        """An executor and how many tasks it runs at a time; leaving by an exception stops them.

        Raises:
            InputError: the scheduler does not answer.
        """
        if self.scheduler is not None:
            with _cluster(self.scheduler) as opened:
                yield opened
            return
        jobs = max(1, min(self.jobs, tasks))
        with processes(jobs) as executor:
            yield executor, jobs


def completed(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    workers: Workers,
    *,
    note: Callable[[str], None] = lambda text: None,
) -> Generator[Finished[Task, Result], None, None]:
    """Do every task and yield each as it ends, in whatever order; tasks start in the order given.

    A worker that dies takes its pool with it: a new pool does what was unfinished. Close the
    iterator to stop the workers.

    Args:
        work: Module-level function; may be called twice for a task whose worker died.
        tasks: What to do; put the longest first.
        workers: Where.
        note: Told in a line of what went wrong and was mended.

    Raises:
        WorkersLost: pools keep dying and nothing gets done.
        InputError: the scheduler does not answer.
    """
    waiting = dict(enumerate(tasks))
    fruitless = 0
    while waiting:
        before = len(waiting)
        with workers.open(before) as (executor, side_by_side):
            for index, future in _submitted(executor, work, waiting):
                try:
                    value, error, cpu_seconds = future.result()
                except (BrokenExecutor, CancelledError):
                    continue
                except Exception as raised:  # the executor's own, not the work's
                    value, error, cpu_seconds = None, _text(raised), 0.0
                yield Finished(waiting.pop(index), value, error, cpu_seconds, side_by_side)
        if not waiting:
            return
        fruitless = fruitless + 1 if len(waiting) == before else 0
        if fruitless == FRUITLESS:
            raise WorkersLost(
                f"{FRUITLESS} times in a row every worker died before it finished anything; "
                f"{len(waiting)} of {len(tasks)} tasks are not done"
            )
        note(f"a worker died: starting {len(waiting)} unfinished tasks again")


def _submitted(
    executor: Executor, work: Callable[[Task], Result], tasks: dict[int, Task]
) -> Iterator[tuple[int, Future[Answer[Result]]]]:
    """The futures of all tasks as they complete."""
    futures: dict[Future[Answer[Result]], int] = {}
    try:
        for index, task in tasks.items():
            with shielded():  # it may start a worker, which is known by then
                futures[executor.submit(_measured, work, task)] = index
    except BrokenExecutor:
        pass  # what was submitted says so too, the rest is unfinished
    for future in as_completed(futures):
        yield futures[future], future


def _measured(work: Callable[[Task], Result], task: Task) -> Answer[Result]:
    """The work's value or error, and the processor time of this process that it took."""
    began = time.process_time()
    value, error = None, None
    try:
        value = work(task)
    except Exception as raised:
        error = _text(raised)
    return value, error, time.process_time() - began


def _text(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


@contextmanager
def processes(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """So many workers, which die with their parent.

    They are fresh interpreters: a fork would share the physics engine's and other libraries' state.
    """
    command_room()  # theirs too: what a killed worker leaves is removed with it
    if TRACKED not in sys.warnoptions:  # handed on to the tracker, and to workers
        sys.warnoptions.append(TRACKED)
    others = {child.pid for child in multiprocessing.active_children()}
    pool = ProcessPoolExecutor(jobs, mp_context=_Deaf(), initializer=tie_to_parent)
    try:
        yield pool
    except BaseException:
        for child in multiprocessing.active_children():
            if child.pid not in others:
                child.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


class _DeafProcess(SpawnProcess):
    """A fresh interpreter that no interrupt reaches before `tie_to_parent` says what to do."""

    def start(self) -> None:
        with deaf():
            super().start()


class _Deaf(SpawnContext):
    Process = _DeafProcess


def tie_to_parent() -> None:
    """Leave interrupts to the parent, and die with it, even if it is killed."""
    for number in TERMINAL:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, TERMINAL)
    parent = multiprocessing.parent_process()
    assert parent is not None
    assert parent.pid is not None
    end_with(parent.pid)


def _security(address: str) -> Any:
    """The certificates of Dask's configuration, `distributed.comm.tls`.

    Raises:
        InputError: there are none though the address needs them, they cannot be read, or the
            address is open though the configuration requires encryption.
    """
    from distributed.security import Security

    try:
        security: Any = Security()
        settings = security.get_connection_args("client")
    except (OSError, ValueError) as error:
        expected = f"certificates that can be read in Dask's configuration ({error})"
        raise InputError("--scheduler", address, expected) from None
    secure = address.startswith("tls://")
    if secure and settings["ssl_context"] is None:
        expected = "certificates in Dask's configuration, distributed.comm.tls"
        raise InputError("--scheduler", address, expected)
    if settings["require_encryption"] and not secure:
        expected = "an address tls://..., as Dask's configuration requires encryption"
        raise InputError("--scheduler", address, expected)
    return security


def _check_answers(address: str) -> None:
    """Refuse an address where nobody listens, before Dask's client tries it again and again.

    Raises:
        InputError: it is no address, or nobody answers.
    """
    until = time.monotonic() + CONNECT_SECONDS
    while True:
        try:
            there = urlsplit(address)
            socket.create_connection((there.hostname, there.port), CONNECT_SECONDS).close()
            return
        except (OSError, ValueError, TypeError) as error:
            starting = isinstance(error, ConnectionRefusedError) and time.monotonic() < until
            if not starting:
                expected = f"a Dask scheduler that answers, as tls://host:8786 ({error})"
                raise InputError("--scheduler", address, expected) from None
        time.sleep(KNOCK_SECONDS)


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """The executor of a Dask client."""
    try:
        from distributed import Client
    except ImportError:
        expected = "the extra [cluster] to be installed (dask, distributed)"
        raise InputError("--scheduler", address, expected) from None
    security = _security(address)
    _check_answers(address)
    try:
        client: Any = Client(
            address, timeout=CONNECT_SECONDS, set_as_default=False, security=security
        )
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        expected = f"a Dask scheduler that answers ({reason})"
        raise InputError("--scheduler", address, expected) from None
    try:
        executor = client.get_executor(pure=False)
        finished = False
        try:
            yield executor, max(1, sum(client.nthreads().values()))
            finished = True
        finally:
            executor.shutdown(wait=finished)
    finally:
        client.close()
