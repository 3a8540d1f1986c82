"""A study survives what happens to processes, and does not depend on who computed it."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.blind.battery import run_battery
from realitygap.studies.blind.trials import blind_config
from realitygap.studies.paper.conditions import PAPER, PlannedRun, StudyConfig, plan
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.execution import RunsFailed, execute, run_files
from realitygap.studies.plumbing.execution import Workers, WorkersLost, completed
from tests.helpers import ENVIRONMENT, children, until, wait_until_gone
from tests.studies.small_study import TINY, WORDS, results

CLI = (sys.executable, "-c", "from realitygap.studies.cli import main; main()", "study", "paper")


@pytest.fixture(scope="module")
def local(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("local") / "study"
    _execute(out, Workers(1))
    return out


def _execute(out: Path, workers: Workers, study: StudyConfig = TINY, *, quiet: bool = True) -> None:
    with StudyDirectory(out, study, plan(study, PAPER)).held() as directory:
        execute(directory, workers, run_files, quiet=quiet)


def test_results_are_the_same_for_any_number_of_workers(local: Path, tmp_path: Path) -> None:
    _execute(tmp_path / "two", Workers(2))
    assert results(tmp_path / "two") == results(local)


def test_a_killed_study_repeats_only_what_was_unfinished(local: Path, tmp_path: Path) -> None:
    out = tmp_path / "study"
    study = subprocess.Popen([*CLI, *WORDS, "--jobs", "1", "--quiet", "--out", str(out)])
    try:
        until(lambda: (out / "runs").is_dir() and len(list((out / "runs").glob("[!.]*"))) >= 2)
        workers = children(study.pid)
    finally:
        study.send_signal(signal.SIGKILL)
        study.wait()
    for worker in workers:
        wait_until_gone(worker)
    finished = {path: path.stat().st_mtime_ns for path in (out / "runs").glob("[!.]*/run.json")}
    assert 2 <= len(finished) < len(PAPER)
    _execute(out, Workers(1))
    assert {path: path.stat().st_mtime_ns for path in finished} == finished
    tables = {name: digest for name, digest in results(out).items() if name.startswith("runs")}
    assert tables == {n: d for n, d in results(local).items() if n.startswith("runs")}


def test_a_study_with_damaged_runs_ends_as_if_they_had_never_been(
    local: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "study"
    runs = shutil.copytree(local, out) / "runs"
    kept = (runs / "fixed-search-00" / "run.json").stat().st_mtime_ns
    shutil.copy(runs / "at-nest-00" / "generations.parquet", runs / "no-light-00")
    (runs / "opposite-00" / "generations.parquet").write_bytes(b"")
    (runs / "fixed-negative-00" / "deposits.parquet").unlink()
    _execute(out, Workers(1), quiet=False)
    said = [line for line in capfd.readouterr().err.splitlines() if "made anew" in line]
    assert said == [
        "run no-light-00 is made anew: its generations.parquet is not as it was written",
        "run opposite-00 is made anew: its generations.parquet is not as it was written",
        "run fixed-negative-00 is made anew: its deposits.parquet is missing",
    ]
    assert results(out) == results(local)
    assert (runs / "fixed-search-00" / "run.json").stat().st_mtime_ns == kept


def test_an_interrupted_study_stops_its_workers_keeps_what_is_whole_and_exits_130(
    tmp_path: Path,
) -> None:
    out, temporary = tmp_path / "study", tmp_path / "temporary"
    temporary.mkdir()
    study = subprocess.Popen(
        [*CLI, *WORDS[:2], "--minutes", "2", *WORDS[4:], "--jobs", "1", "--quiet", "--out", out],
        env={**ENVIRONMENT, "TMPDIR": str(temporary)},
        stderr=subprocess.PIPE,
    )
    try:
        until(lambda: (out / "runs").is_dir() and len(list((out / "runs").glob("[!.]*"))) >= 1)
        workers = children(study.pid)
    finally:
        study.send_signal(signal.SIGINT)
        _, said = study.communicate(timeout=300)
    assert study.returncode == 130
    assert said == b"realitygap: interrupted\n"
    assert not list(temporary.iterdir())
    assert {path.name for path in tmp_path.iterdir()} == {"study", "temporary"}
    for worker in workers:
        wait_until_gone(worker)
    with StudyDirectory(out, *_planned(minutes=2.0)).held() as directory:
        assert 0 < len(directory.pending()) < len(PAPER)
        assert directory.sessions[-1]["runs"] >= 1


def _planned(minutes: float) -> tuple[StudyConfig, tuple[PlannedRun, ...]]:
    study = TINY.model_copy(update={"minutes": minutes})
    return study, plan(study, PAPER)


def test_a_killed_worker_is_replaced_and_its_run_repeated(
    local: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "study"
    with StudyDirectory(out, TINY, plan(TINY, PAPER)).held() as directory:
        keep = directory.keep
        killed = []

        def keep_and_kill(*args: object) -> None:
            keep(*args)  # type: ignore[arg-type]
            if not killed:
                killed.extend(_worker_processes())
                os.kill(killed[0], signal.SIGKILL)

        directory.keep = keep_and_kill  # type: ignore[method-assign]
        execute(directory, Workers(1), run_files, quiet=False)
    assert killed
    said = capfd.readouterr().err
    assert "a worker died: starting" in said
    assert re.search(r"8 of 8 runs, [\d.]+ simulated hours per minute, 0 s left", said)
    assert results(out) == results(local)


def _worker_processes() -> list[int]:
    import multiprocessing

    return [child.pid for child in multiprocessing.active_children() if child.pid is not None]


def _die(task: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def test_work_that_always_kills_its_worker_ends_with_an_error() -> None:
    said: list[str] = []
    with pytest.raises(WorkersLost, match="2 of 2 tasks are not done"):
        list(completed(_die, [1, 2], Workers(1), note=said.append))
    assert len(said) == 2


def test_a_run_that_fails_does_not_cost_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = plan(TINY, PAPER[:2])
    broken = runs[0].config.model_copy(update={"reading": "no such reading"})
    object.__setattr__(runs[0], "config", broken)
    with StudyDirectory(tmp_path / "study", TINY, runs).held() as directory:
        with pytest.raises(RunsFailed, match="no-light-00"):
            execute(directory, Workers(1), run_files, quiet=True)
        assert [run.name for run in directory.pending()] == ["no-light-00"]


def test_a_changed_configuration_is_refused_with_what_differs(local: Path) -> None:
    changed = TINY.model_copy(update={"minutes": 7.0})
    with pytest.raises(InputError, match=r"minutes 0\.1 there, 7\.0 now"):
        _execute(local, Workers(1), changed)


def test_a_study_is_not_run_twice_at_once(tmp_path: Path) -> None:
    runs = plan(TINY, PAPER)
    with (
        StudyDirectory(tmp_path / "study", TINY, runs).held(),
        pytest.raises(InputError, match="no other command is writing to"),
        StudyDirectory(tmp_path / "study", TINY, runs).held(),
    ):
        pass


def test_a_directory_with_other_things_in_it_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match="new or empty directory"):
        _execute(tmp_path, Workers(1))


def test_a_run_of_a_study_equals_the_same_single_run(local: Path, tmp_path: Path) -> None:
    run = plan(TINY, PAPER)[1]
    out = tmp_path / "run"
    words = ["run", "--case", run.config.case, "--minutes", "0.1", "--robots", "2", "--quiet"]
    words += ["--seed", str(run.config.seed), "--no-samples", "--out", str(out)]
    subprocess.run([*CLI[:3], *words], check=True)
    for name in ("generations.parquet", "deposits.parquet"):
        assert (out / name).read_bytes() == (local / "runs" / run.name / name).read_bytes()


@pytest.fixture
def cluster() -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two worker processes on loopback."""
    pytest.importorskip("distributed")
    from distributed import Client

    port = _free_port()
    address = f"tcp://127.0.0.1:{port}"
    scheduler = _dask("scheduler", "--port", str(port))
    _wait_for(port)
    workers = [_dask("worker", address, "--nthreads", "1", "--no-nanny") for _ in range(2)]
    try:
        with Client(address, timeout=300, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=300)
        yield address, workers
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def _dask(what: str, *words: str) -> subprocess.Popen[bytes]:
    module = f"distributed.cli.dask_{what}"
    command = [sys.executable, "-m", module, *words, "--host", "127.0.0.1", "--no-dashboard"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _wait_for(port: int) -> None:
    """Until something listens there: who comes too early is cut off while a scheduler starts."""
    import socket

    until = time.monotonic() + 300.0
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), 300.0).close()
        except OSError:
            assert time.monotonic() < until, "no scheduler"
            time.sleep(0.1)
        else:
            return


def _free_port() -> int:
    import socket

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def test_a_cluster_whose_workers_come_and_go_computes_the_same_bytes(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], local: Path, tmp_path: Path
) -> None:
    """After the first run a worker joins and the first two are killed: it does the rest."""
    from distributed import Client

    address, processes = cluster
    out = tmp_path / "study"
    with StudyDirectory(out, TINY, plan(TINY, PAPER)).held() as directory:
        keep = directory.keep

        def keep_and_exchange(*args: object) -> None:
            keep(*args)  # type: ignore[arg-type]
            if len(processes) == 2:
                processes.append(_dask("worker", address, "--nthreads", "1", "--no-nanny"))
                with Client(address, timeout=300, set_as_default=False) as client:
                    client.wait_for_workers(3, timeout=300)
                for process in processes[:2]:
                    process.kill()

        directory.keep = keep_and_exchange  # type: ignore[method-assign]
        execute(directory, Workers(1, address), run_files, quiet=True)
        assert directory.sessions[-1]["scheduler"] == address
    assert [process.poll() is None for process in processes] == [False, False, True]
    assert results(out) == results(local)


@pytest.mark.slow
def test_a_blind_battery_on_a_cluster_is_the_one_of_local_processes(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], tmp_path: Path
) -> None:
    config = blind_config(trials=4, seed=2, effects=("ls_dead_sensor",), robots=3, seconds=(10.0,))
    summaries = [
        run_battery(config, tmp_path / name, workers, quiet=True)
        for name, workers in (("local", Workers(1)), ("cluster", Workers(1, cluster[0])))
    ]
    for summary in summaries:
        del summary["diagnose_seconds"]
    assert (summaries[0]["trials"], summaries[0]["failed"]) == (4, [])
    assert summaries[0] == summaries[1]


def test_a_scheduler_that_does_not_answer_is_one_clear_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("realitygap.studies.plumbing.execution.CONNECT_SECONDS", 0.5)
    with pytest.raises(InputError, match="a Dask scheduler that answers"):
        _execute(tmp_path / "study", Workers(1, f"tcp://127.0.0.1:{_free_port()}"))
