"""Output is claimed, whole or absent, and never takes the place of what was not checked."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import Popen
from typing import Any

import pytest
from typer.testing import CliRunner

from realitygap.embedded_sim import InputError
from realitygap.studies.cli import app
from realitygap.studies.plumbing import renames
from realitygap.studies.plumbing.output import claimed, whole_directory, whole_file
from realitygap.studies.plumbing.rooms import LOCK, clear_stale, scratch, take
from tests.helpers import ENVIRONMENT, ROOT, realitygap

COMMANDS = {
    "run": ("run", "--minutes", "0.1"),
    "capture": ("capture",),
    "demo": ("demo",),
    "gap": ("gap", "no-log"),
    "diagnose": ("diagnose", "no-log"),
    "gain": ("gain", "--log", "no-log", "--extended", "no.toml"),
    "import": ("import", "optiodom", "no-directory"),
    "reference": ("reference", "no-log"),
    "study": ("study", "paper", "--runs", "1"),
    "readings": ("study", "readings", "--runs", "1"),
    "transfer": ("study", "transfer", "--runs", "1"),
    "blind": ("blind", "--trials", "1"),
}


@pytest.fixture(params=["renameat2", "posix"])
def file_system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the kernel's own calls, and as on a file system that lacks them."""
    if request.param == "posix":
        monkeypatch.setattr(renames, "_renameat2", lambda: None)


def tree(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): path.read_text()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_refused_an_output_that_another_writes_to(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with claimed(Path("out.csv")):
        done = CliRunner().invoke(app, [*COMMANDS[command], "--out", "out.csv"])
    assert isinstance(done.exception, InputError)
    assert f"no other command is writing to (process {os.getpid()}, since " in str(done.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_replaces_a_file_that_it_has_not_written(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("out.csv").write_text("a thesis")
    forced = () if command in ("study", "readings", "transfer", "blind") else ("--force",)
    done = CliRunner().invoke(app, [*COMMANDS[command], "--out", "out.csv", *forced])
    assert isinstance(done.exception, InputError)
    assert done.exception.field == "--out"
    assert tree(tmp_path) == {"out.csv": "a thesis"}


def test_a_refusal_names_whoever_writes_in_one_line_and_exits_2(tmp_path: Path) -> None:
    with claimed(tmp_path / "out"):
        done = realitygap("run", "--minutes", "0.1", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert f"process {os.getpid()}, since " in done.stderr


def test_links_to_one_place_are_one_place(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    with (
        claimed(tmp_path / "link" / "out"),
        pytest.raises(InputError, match="no other command"),
        claimed(tmp_path / "real" / "out"),
    ):
        pass


HOLD = """
import sys, threading
from pathlib import Path
from realitygap.studies.plumbing.output import whole_directory
with whole_directory(Path(sys.argv[1])) as part:
    (part / "half").write_text("half")
    print("holds", flush=True)
    threading.Event().wait()
"""


@contextmanager
def running(script: str, *words: str, **variables: str) -> Iterator[tuple[Popen[str], str]]:
    """A process that never ends by itself, and the first line it says."""
    process = Popen(
        [sys.executable, "-c", script, *words],
        cwd=ROOT,
        env={**ENVIRONMENT, **variables},
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        yield process, process.stdout.readline().strip()
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("target", ["same", "other"])
def test_what_a_killed_command_left_is_cleared_by_the_next_and_a_living_ones_never(
    tmp_path: Path, target: str
) -> None:
    same, other = str(tmp_path / "same"), str(tmp_path / "living")
    with running(HOLD, same) as (killed, _), running(HOLD, other):
        killed.kill()
        killed.wait()
        assert (tmp_path / ".same.part/new/same/half").exists()
        with whole_directory(tmp_path / target) as part:
            (part / "run.json").write_text("{}")
        rooms = [path.name for path in tmp_path.glob(".*")]
        assert rooms == [".living.part"]
        assert (tmp_path / ".living.part/new/living/half").exists()


def test_a_strangers_directory_is_never_taken_for_a_room(tmp_path: Path) -> None:
    (tmp_path / ".out.part").mkdir()
    (tmp_path / ".out.part" / "thesis.tex").write_text("all of it")
    (tmp_path / ".other.part").mkdir()
    clear_stale(tmp_path, ".", ".part")
    with (
        pytest.raises(InputError, match="in the way"),
        whole_directory(tmp_path / "out"),
    ):
        pass
    assert tree(tmp_path) == {".out.part/thesis.tex": "all of it"}
    assert (tmp_path / ".other.part").is_dir()


def write(out: Path, force: bool, meanwhile: Callable[[], object]) -> None:
    """A command; in the middle of its work something else happens."""
    if out.suffix:
        with whole_file(out, force=force) as part:
            part.write_text("new")
            meanwhile()
    else:
        with whole_directory(out, force=force, holds=("run.json",)) as part:
            (part / "run.json").write_text("new")
            (part / "deep").mkdir()
            (part / "deep" / "er").write_text("new")
            meanwhile()


@pytest.mark.usefixtures("file_system")
@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize(("name", "kept"), [("out", "out.kept-1"), ("o.csv", "o.kept-1.csv")])
@pytest.mark.parametrize("made", ["file", "directory", "empty directory"])
def test_what_appears_meanwhile_stays_and_the_result_is_kept_beside_it(
    tmp_path: Path, name: str, kept: str, made: str, force: bool
) -> None:
    out = tmp_path / name

    def meanwhile() -> None:
        if made == "file":
            out.write_text("theirs")
        else:
            out.mkdir()
        if made == "directory":
            (out / "thesis").write_text("theirs")

    with pytest.raises(InputError, match=rf"what was computed is kept in \S*{kept}$"):
        write(out, force, meanwhile)
    found = tree(tmp_path)
    theirs = {key: text for key, text in found.items() if text == "theirs"}
    assert theirs == {"file": {name: "theirs"}, "directory": {f"{name}/thesis": "theirs"}}.get(
        made, {}
    )
    assert out.exists()
    assert (tmp_path / kept).exists()
    assert {text for key, text in found.items() if key.startswith(kept)} == {"new"}
    assert {path.name for path in tmp_path.iterdir()} == {name, kept}


CHANGES: dict[str, Callable[[Path], Any]] = {
    "a file is added": lambda out: (out / "thesis").write_text("theirs"),
    "a file is changed": lambda out: (out / "run.json").write_text("changed"),
    "a file is removed": lambda out: (out / "run.json").unlink(),
    "deep down": lambda out: (out / "deep" / "new").write_text("theirs"),
    "another directory": lambda out: (out.rename(out.with_name("moved")), out.mkdir()),
}


@pytest.mark.usefixtures("file_system")
@pytest.mark.parametrize("change", CHANGES)
def test_force_replaces_only_what_was_there_when_it_was_checked(
    tmp_path: Path, change: str
) -> None:
    out = tmp_path / "out"
    (out / "deep").mkdir(parents=True)
    (out / "run.json").write_text("old")
    after: dict[str, str] = {}

    def meanwhile() -> None:
        CHANGES[change](out)
        after.update(tree(out))

    with pytest.raises(InputError, match="kept in"):
        write(out, True, meanwhile)
    assert tree(out) == after
    assert tree(tmp_path / "out.kept-1")["run.json"] == "new"


@pytest.mark.usefixtures("file_system")
@pytest.mark.parametrize("name", ["out", "o.csv"])
def test_force_replaces_what_is_unchanged_or_gone(tmp_path: Path, name: str) -> None:
    out, away = tmp_path / name, tmp_path / "away"
    for meanwhile in (lambda: None, lambda: None, lambda: out.rename(away)):
        write(out, True, meanwhile)
        assert out.exists()
    assert {path.name for path in tmp_path.iterdir()} == {name, "away"}
    assert set(tree(tmp_path).values()) == {"new"}


def test_a_link_to_a_directory_stays_and_what_it_means_is_replaced(tmp_path: Path) -> None:
    write(tmp_path / "real", False, lambda: None)
    (tmp_path / "link").symlink_to("real")
    (tmp_path / "real" / "old").write_text("")
    write(tmp_path / "link", True, lambda: None)
    assert (tmp_path / "link").is_symlink()
    assert "old" not in tree(tmp_path / "real")


def test_everything_is_on_the_disk_before_its_name_and_the_name_before_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []

    def synced(descriptor: int) -> None:
        done.append(Path(os.readlink(f"/proc/self/fd/{descriptor}")).name)

    def placed(source: Path, target: Path) -> None:
        done.append("renamed")
        source.rename(target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr("realitygap.studies.plumbing.output.place", placed)
    out = tmp_path / "parent" / "out"
    write(out, False, lambda: None)
    assert done[0] == tmp_path.name  # holds the name of the parent, which had to be made
    before, after = done[1 : done.index("renamed")], done[done.index("renamed") + 1 :]
    assert sorted(before) == ["deep", "er", "out", "run.json"]
    assert before.index("er") < before.index("deep") < before.index("out")
    assert after == ["parent"]


def test_work_that_fails_leaves_nothing_and_takes_its_parents_along(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        write(tmp_path / "a" / "b" / "out", False, lambda: 1 // 0)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("out", "more"),
    [
        ("nowhere", []),
        (os.fsdecode(b"caf\xe9"), []),
        ("/", []),
        ("/dev/full", ["--force"]),
        ("thesis", ["--force"]),
        ("a" * 256, []),
    ],
)
def test_an_output_that_is_no_place_for_it_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, out: str, more: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("nowhere").symlink_to("missing")
    Path("thesis").write_text("all of it")
    done = CliRunner().invoke(app, ["capture", *more, "--out", out])
    assert isinstance(done.exception, InputError)
    assert str(done.exception).startswith("--out: got ")
    assert {path.name for path in tmp_path.iterdir()} == {"nowhere", "thesis"}
    assert Path("thesis").read_text() == "all of it"


def test_a_name_that_is_not_text_is_one_line(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "realitygap.studies.command", "capture", "--out", b"caf\xe9"],
        cwd=tmp_path,
        env=ENVIRONMENT,
        capture_output=True,
        check=False,
    )
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1), done.stderr
    assert not list(tmp_path.iterdir())


def test_a_log_is_not_replaced_by_what_is_imported_from_it(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("run,robot,t,x,y,yaw\n")
    (tmp_path / "map.toml").write_text("")
    words = ("import", "csv", log, "--map", tmp_path / "map.toml", "--out", log, "--force")
    done = realitygap(*words)
    assert (done.returncode, log.read_text()) == (2, "run,robot,t,x,y,yaw\n")
    assert "another file than what is read" in done.stderr


SCRATCH = """
import subprocess, sys, threading
from realitygap.studies.plumbing.rooms import scratch
with scratch() as room:
    (room / "log").write_text("big")
    print(room, flush=True)
    threading.Event().wait()
"""


def test_temporary_files_of_a_killed_command_are_cleared_by_the_next_and_a_living_ones_never(
    tmp_path: Path,
) -> None:
    stranger = tmp_path / "realitygap-notes"
    stranger.mkdir()
    here = {"TMPDIR": str(tmp_path)}
    with running(SCRATCH, **here) as (killed, stale), running(SCRATCH, **here) as (_, used):
        killed.kill()
        killed.wait()
        assert Path(stale, "log").exists()
        command = [sys.executable, "-m", "realitygap.studies.command", "effects", "--quiet"]
        subprocess.run(
            command, cwd=ROOT, env={**ENVIRONMENT, **here}, check=True, capture_output=True
        )
        assert not Path(stale).parent.exists()
        assert Path(used, "log").exists()
        assert stranger.exists()


def test_a_commands_temporary_files_are_in_one_room_that_goes_with_it(tmp_path: Path) -> None:
    done = subprocess.run(
        [
            *(sys.executable, "-c"),
            "from realitygap.studies.plumbing.rooms import command_room, scratch\n"
            "with scratch() as a, scratch() as b: assert a.parent == b.parent == command_room()\n"
            "assert not a.exists() and command_room().exists()\n"
            "(command_room() / 'forgotten').touch()\n",
        ],
        cwd=ROOT,
        env={**ENVIRONMENT, "TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert not list(tmp_path.iterdir())


def test_a_room_has_one_owner_and_is_gone_with_all_in_it(tmp_path: Path) -> None:
    room = take(tmp_path / "room")
    (room.path / "file").touch()
    assert (room.path / LOCK).exists()
    room.close()
    assert not room.path.exists()
    with scratch() as folder:
        assert folder.is_dir()
    assert not folder.exists()
