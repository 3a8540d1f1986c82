"""A finished piece is taken for finished only if it is; what is not is made anew and said."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.measure import gain as gains
from realitygap.studies.paper.conditions import PAPER, plan, study_config
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.plumbing import manifest, provenance
from realitygap.studies.plumbing.execution import Finished, Workers
from realitygap.studies.plumbing.manifest import MANIFEST, Pieces, made
from realitygap.studies.plumbing.provenance import ROOMS, ROOT, sources_hash, versions
from realitygap.studies.run.experiment import RunConfig, simulate
from tests.studies.small_study import TINY

FILES = {"run.json": b"{}", "generations.parquet": b"generations", "deposits.parquet": b"deposits"}
WANTED = {name: {"config": {"seed": seed, "minutes": 0.1}} for seed, name in enumerate("abc")}


def pieces(room: Path) -> Pieces:
    """Three whole pieces."""
    found = Pieces(room, "run")
    room.mkdir()
    for name, origin in WANTED.items():
        found.keep(name, origin, {k: v + name.encode() for k, v in FILES.items()})
    return found


def _replaced(path: Path, content: bytes = b"") -> None:
    path.write_bytes(content)


def _edited(path: Path, **changes: Any) -> None:
    noted = json.loads(path.read_text())
    for key, value in changes.items():
        noted[key] = {**noted[key], **value} if isinstance(value, dict) else value
    path.write_text(json.dumps(noted))


def _a_file(path: Path) -> None:
    shutil.rmtree(path)
    path.write_text("notes")


def _a_link(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))
    path.symlink_to("nowhere")


DAMAGES: Mapping[str, tuple[Callable[[Path], object], str]] = {
    "another run's table": (
        lambda p: shutil.copy(p.parent / "c" / "generations.parquet", p),
        "generations.parquet is not as it was written",
    ),
    "an empty table": (
        lambda p: _replaced(p / "generations.parquet"),
        "generations.parquet is not as it was written",
    ),
    "a table cut short": (
        lambda p: _replaced(p / "generations.parquet", b"gener"),
        "generations.parquet is not as it was written",
    ),
    "a table that is gone": (
        lambda p: (p / "generations.parquet").unlink(),
        "generations.parquet is missing",
    ),
    "a table that is a directory": (
        lambda p: ((p / "run.json").unlink(), (p / "run.json").mkdir()),
        "run.json is not as it was written",
    ),
    "a file too many": (lambda p: _replaced(p / "diagnosis.json"), "diagnosis.json is not of it"),
    "another run": (
        lambda p: (shutil.rmtree(p), shutil.copytree(p.parent / "c", p)),
        "it is another's, with config.seed 2, not 1",
    ),
    "an older program's run": (
        lambda p: _edited(p / MANIFEST, versions={"program": "0" * 64}),
        "another program made it, with program 0000",
    ),
    "another library's run": (
        lambda p: _edited(p / MANIFEST, versions={"numpy": "1.0"}),
        "another program made it, with numpy 1.0",
    ),
    "no manifest": (lambda p: (p / MANIFEST).unlink(), "it has no manifest.json"),
    "an empty directory": (
        lambda p: (shutil.rmtree(p), p.mkdir()),
        "it has no manifest.json",
    ),
    "a manifest cut short": (
        lambda p: _replaced(p / MANIFEST, (p / MANIFEST).read_bytes()[:50]),
        "its manifest.json cannot be read",
    ),
    "a manifest of nothing but brackets": (
        lambda p: _replaced(p / MANIFEST, b"[" * 100_000),
        "its manifest.json cannot be read",
    ),
    "a manifest that names no files": (
        lambda p: _edited(p / MANIFEST, files=None),
        "its manifest.json cannot be read",
    ),
    "a later manifest": (
        lambda p: _edited(p / MANIFEST, schema=2),
        "its manifest.json cannot be read",
    ),
    "a file in its place": (_a_file, "it has no manifest.json"),
    "a pipe for a manifest": (
        lambda p: ((p / MANIFEST).unlink(), os.mkfifo(p / MANIFEST)),
        "it has no manifest.json",
    ),
    "a dangling link in its place": (_a_link, "it has no manifest.json"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_a_piece_that_is_not_what_it_should_be_is_made_anew_and_said_in_a_line(
    name: str, tmp_path: Path
) -> None:
    damage, why = DAMAGES[name]
    found = pieces(tmp_path / "runs")
    kept = {path: path.read_bytes() for path in (tmp_path / "runs" / "a").iterdir()}
    damage(found.path("b"))
    said: list[str] = []
    assert found.missing(WANTED, said.append) == ["b"]
    assert len(said) == 1
    assert said[0].startswith("run b is made anew: ")
    assert why in said[0]
    assert not found.path("b").exists()
    assert {path: path.read_bytes() for path in kept} == kept
    found.keep("b", WANTED["b"], FILES)
    assert found.missing(WANTED, said.append) == []
    assert len(said) == 1


def test_a_whole_piece_is_used_again_and_nothing_is_said(tmp_path: Path) -> None:
    found = pieces(tmp_path / "runs")
    said: list[str] = []
    assert found.missing({**WANTED, "d": {"config": {"seed": 9}}}, said.append) == ["d"]
    assert said == []
    assert found.files("a") == {k: v + b"a" for k, v in sorted(FILES.items())}


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_no_change_of_a_byte_goes_unnoticed(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    found = pieces(tmp_path_factory.mktemp("pieces") / "runs")
    path = data.draw(st.sampled_from(sorted(p for p in found.path("a").iterdir())))
    content = path.read_bytes()
    at = data.draw(st.integers(0, len(content) - 1))
    byte = data.draw(st.integers(0, 255).filter(lambda one: one != content[at]))
    path.write_bytes(content[:at] + bytes([byte]) + content[at + 1 :])
    same = path.name == MANIFEST and _same_json(path.read_bytes(), content)
    assert found.missing(WANTED) == ([] if same else ["a"])


def _same_json(one: bytes, other: bytes) -> bool:
    try:
        return bool(json.loads(one) == json.loads(other))
    except ValueError:
        return False


@settings(max_examples=50, deadline=None)
@given(name=st.text(min_size=1), value=st.text())
def test_what_a_foreign_manifest_says_is_shown_in_one_short_line(name: str, value: str) -> None:
    said = manifest._difference({"config": {name: value}}, {"config": {}})
    assert said is not None
    assert said.isprintable()
    assert len(said) < 200


def test_a_changed_added_or_renamed_source_is_another_program(tmp_path: Path) -> None:
    room = tmp_path / "models"
    (room / "__pycache__").mkdir(parents=True)
    (room / "law.py").write_text("LAW = 1\n")
    before = sources_hash([room])
    for made_by_machines in ("__pycache__/law.pyc", "_core.c", "_core.so", "notes.txt"):
        (room / made_by_machines).write_text("anything")
        assert sources_hash([room]) == before
    (room / "law.py").write_text("LAW = 2\n")
    changed = sources_hash([room])
    (room / "law.py").rename(room / "laws.py")
    renamed = sources_hash([room])
    (room / "table.npz").write_bytes(b"table")
    assert len({before, changed, renamed, sources_hash([room])}) == 4


def test_the_program_is_all_rooms_with_their_data() -> None:
    assert versions()["program"] == sources_hash(ROOT / room for room in ROOMS)
    kinds = {p.suffix for room in ROOMS for p in (ROOT / room).rglob("*") if p.is_file()}
    assert kinds - set(provenance.SOURCES) <= {".so", ".pyc"}


@pytest.fixture
def another_program(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Changes the program from when it is called."""

    def change() -> None:
        other = tuple({**versions(), "program": "1" * 64}.items())
        monkeypatch.setattr(provenance, "_versions", lambda: other)

    return change


def test_a_study_is_not_resumed_by_a_changed_program_and_keeps_what_it_has(
    tmp_path: Path, another_program: Callable[[], None]
) -> None:
    out, runs = tmp_path / "study", plan(TINY, PAPER)
    with StudyDirectory(out, TINY, runs).held() as directory:
        directory.keep(runs[0], FILES)
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    another_program()
    with (
        pytest.raises(InputError, match=r"program \w+ there, 1111\w+ now"),
        StudyDirectory(out, TINY, runs).held(),
    ):
        pass
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


def _twice(task: int) -> int:
    return 2 * task


@pytest.mark.parametrize("numpy", [versions()["numpy"], "1.0"])
def test_results_of_workers_with_another_program_are_not_taken(
    numpy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def elsewhere(
        work: Callable[[int], Any], tasks: list[int], workers: Workers, **more: object
    ) -> Iterator[Finished[int, Any]]:
        for task in tasks:
            program, value = work(task)
            yield Finished(task, ({**program, "numpy": numpy}, value), None, 0.0, 1)

    monkeypatch.setattr(manifest, "completed", elsewhere)
    results = made(_twice, [4], Workers(1))
    if numpy == versions()["numpy"]:
        assert [one.value for one in results] == [8]
        return
    with pytest.raises(InputError, match=r"program: got a worker with numpy 1\.0, not"):
        list(results)


def _refused(
    words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> str:
    """What a command says that ends with exit code 2 and one line."""
    from realitygap.studies.cli import main

    monkeypatch.setattr("sys.argv", ["realitygap", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr().err
    assert (ended.value.code, said.count("\n")) == (2, 1)
    return said


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'"text"', b"[" * 100_000, b"\xff"])
@pytest.mark.parametrize(
    ("words", "notes"),
    [
        (("study", "paper", "--runs", "1"), "study.json"),
        (("blind", "--trials", "1"), "battery.json"),
    ],
)
def test_damaged_notes_of_what_was_begun_are_one_clear_line(
    words: tuple[str, ...],
    notes: str,
    content: bytes,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / notes).write_bytes(content)
    said = _refused((*words, "--out", str(tmp_path / "out")), monkeypatch, capsys)
    assert f"the {notes} of a" in said
    assert "damaged" in said
    assert (tmp_path / "out" / notes).read_bytes() == content


@pytest.mark.parametrize(
    ("folder", "words"), [("runs", ("study", "paper")), ("trials", ("blind",))]
)
def test_a_folder_of_pieces_that_nobody_began_is_left_alone(
    folder: str,
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    thesis = tmp_path / "out" / folder / "no-light-00" / "thesis.tex"
    thesis.parent.mkdir(parents=True)
    thesis.write_text("all of it")
    said = _refused((*words, "--out", str(tmp_path / "out")), monkeypatch, capsys)
    assert "a new or empty directory" in said
    assert thesis.read_text() == "all of it"


def _measured(
    work: object, tasks: list[Any], workers: Workers, *, note: Callable[[str], None]
) -> Iterator[Finished[Any, Any]]:
    """In place of `made`: no physics."""
    for task in tasks:
        group, healthy = task
        table = pd.DataFrame({"run": ["00"], "total": [float(group.index)], "healthy": [healthy]})
        yield Finished(task, ({"verdict": "nothing_wrong"}, table), None, 0.0, 1)


def test_a_catalogue_of_gains_is_resumed_group_by_group_and_never_mixed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gains, "made", _measured)
    monkeypatch.setattr(gains, "rows_of", lambda hidden, *found: [{"effect": hidden[0].name}])
    asked: dict[str, Any] = {"times": 2.0, "runs": 1, "minutes": 0.1, "seed": 1}
    planned = gains.groups(("motor_lag", "lamp_moved"), **asked, draws=1)
    out, said = tmp_path / "gains", list[str]()

    def run(seed: int = 1) -> list[str]:
        table = gains.run_catalogue(planned, {**asked, "seed": seed}, out, Workers(1), said.append)
        return list(table["effect"])

    assert run() == ["motor_lag", "lamp_moved"]
    assert said == ["healthy: done", "group-00: done", "group-01: done"]
    said.clear()
    assert run() == ["motor_lag", "lamp_moved"]
    assert said == []
    errors = out / "groups" / "group-01" / "errors.parquet"
    errors.write_bytes(errors.read_bytes()[:40])
    assert run() == ["motor_lag", "lamp_moved"]
    why = "group group-01 is made anew: its errors.parquet is not as it was written"
    assert said == [why, "group-01: done"]
    with pytest.raises(InputError, match="seed 1 there, 2 now"):
        run(seed=2)


def test_a_study_is_resumed_with_the_very_same_model_and_tables_only(tmp_path: Path) -> None:
    from realitygap.models.belief.modelfile import find_model_file

    source = find_model_file("epuck")
    text = source.read_text().replace("../captured/epuck.npz", "epuck.npz")
    model = tmp_path / "mine.toml"
    model.write_text(text)
    (tmp_path / "epuck.npz").write_bytes(
        (source.parent / "../captured/epuck.npz").resolve().read_bytes()
    )
    first = study_config(model=str(model))
    model.write_text(text + "\n# another file\n")
    second = study_config(model=str(model))
    assert first.model == second.model == str(model)
    assert first.model_hash != second.model_hash


def test_a_log_to_be_diagnosed_says_nothing_of_the_run_in_its_run_column(tmp_path: Path) -> None:
    from realitygap.studies.run.experiment import ANONYMOUS

    config = RunConfig(minutes=0.02, robots=2, seed=987654321, controller="search")
    simulate(config, (), tmp_path, name=ANONYMOUS)
    assert set(pd.read_parquet(tmp_path / "samples.parquet")["run"]) == {"log"}


def test_a_checkout_tells_its_commit_and_anything_else_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = []
    for there in (False, True):
        provenance.commit.cache_clear()
        monkeypatch.setattr(provenance, "ROOT", tmp_path)
        if there:
            for words in (("init", "-q"), ("commit", "-q", "--allow-empty", "-m", "first")):
                who = ("-c", "user.name=a", "-c", "user.email=a@b")
                subprocess.run(("git", *who, "-C", str(tmp_path), *words), check=True)
        said.append(provenance.commit())
    head = ("git", "-C", str(tmp_path), "rev-parse", "HEAD")
    whole = subprocess.run(head, capture_output=True, text=True, check=True).stdout
    provenance.commit.cache_clear()
    assert said[0] is None
    assert said[1] is not None
    assert whole.startswith(said[1])
