"""Whatever a reader is given, it comes to a value or one `InputError`, in bounded time and memory.

`make fuzz` gives every reader many inputs: REALITYGAP_FUZZ of each. What was found is in `corpus`.
"""

from __future__ import annotations

import json
import os
import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer.main
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from realitygap.reality.effects import catalogue
from realitygap.reality.effects.effect import Key
from realitygap.studies.cli import app
from tests.fuzz.child import Child
from tests.fuzz.corpus import CORPUS, LOGS, SLOW, SPECS, WORDS
from tests.fuzz.damage import damaged, edits
from tests.fuzz.readers import READERS, WRITERS, table_of
from tests.fuzz.tables import changed, changes
from tests.helpers import ROOT

INPUTS = int(os.environ.get("REALITYGAP_FUZZ", "0"))
"""Of each reader; 0: a few, always the same ones."""
FEW = 12
FILES = [name for name, reader in READERS.items() if reader.files is not dict]
TABLES = [name for name, reader in READERS.items() if reader.table]

budget = settings(
    max_examples=INPUTS or FEW,
    derandomize=not INPUTS,
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture(scope="module")
def child() -> Iterator[Child]:
    one = Child()
    yield one
    one.close()


@pytest.fixture
def count(request: pytest.FixtureRequest) -> Iterator[Counter[str]]:
    """How readings ended; kept for the long budget."""
    counted: Counter[str] = Counter()
    yield counted
    if INPUTS:
        room = ROOT / "out" / "fuzz"
        room.mkdir(parents=True, exist_ok=True)
        (room / f"{request.node.name}.json").write_text(json.dumps(counted) + "\n")


def check(child: Child, reader: str, given: Path | str | list[str], count: Counter[str]) -> None:
    ended = child.read(reader, given)
    count[ended.how] += 1
    assert ended.how in ("value", "refused"), f"{ended.how}: {ended.said}"


def laid_out(room: Path, reader: str, name: str, content: bytes) -> Path:
    for file, sound in {**READERS[reader].files(), name: content}.items():
        (room / file).write_bytes(sound)
    return room


@pytest.mark.parametrize("reader", FILES)
def test_a_sound_file_is_read(reader: str, tmp_path: Path, child: Child) -> None:
    for file, sound in READERS[reader].files().items():
        (tmp_path / file).write_bytes(sound)
    ended = child.read(reader, tmp_path)
    assert ended.how == "value", ended.said


@pytest.mark.parametrize("reader", FILES)
def test_a_damaged_file_is_read_or_refused(
    reader: str, tmp_path: Path, child: Child, count: Counter[str]
) -> None:
    sound = READERS[reader].files()

    @budget
    @given(name=st.sampled_from(READERS[reader].damaged), done=edits)
    def holds(name: str, done: list) -> None:
        room = laid_out(tmp_path, reader, name, damaged(sound[name], done))
        check(child, reader, room, count)

    holds()


@pytest.mark.parametrize("reader", TABLES)
def test_a_table_of_other_columns_is_read_or_refused(
    reader: str, tmp_path: Path, child: Child, count: Counter[str]
) -> None:
    name = READERS[reader].table
    frame, write = table_of(reader), WRITERS[Path(name).suffix]

    @budget
    @given(done=changes)
    def holds(done: list) -> None:
        try:
            content = write(changed(frame, done))
        except Exception:
            return  # what cannot be written cannot be read
        check(child, reader, laid_out(tmp_path, reader, name, content), count)

    holds()


def test_a_packed_text_may_be_damaged_before_it_was_packed(
    tmp_path: Path, child: Child, count: Counter[str]
) -> None:
    import gzip

    text = gzip.decompress(READERS["packed csv"].files()["log.csv.gz"])

    @budget
    @given(done=edits)
    def holds(done: list) -> None:
        (tmp_path / "log.csv.gz").write_bytes(gzip.compress(damaged(text, done), 1))
        check(child, "packed csv", tmp_path, count)

    holds()


def _sound(parameter: Key) -> str:
    """A value that a key may have."""
    if parameter.words:
        return parameter.words[0]
    return f"{min(max(1.0, parameter.low), parameter.high):g}"


numbers = st.one_of(
    st.integers().map(str),
    st.floats().map(str),
    st.sampled_from(["1e999", "-1", "9" * 5000, "1" + "0" * 400, "nan", "0x10", "1_000", "", "٣"]),
)
SOUND = [
    f"{name}:{','.join(f'{key}={_sound(one)}' for key, one in effect.parameters.items())}"
    + (",robot=3" if effect.per_robot else "")
    for name, effect in catalogue().items()
]
specs = st.tuples(st.sampled_from(SOUND), st.just([]) | edits).map(
    lambda given: os.fsdecode(damaged(given[0].encode(), given[1]))
)


def test_a_spec_is_read_or_refused(child: Child, count: Counter[str]) -> None:
    @budget
    @given(text=specs | st.text(max_size=40))
    def holds(text: str) -> None:
        check(child, "SPEC", text, count)

    holds()


paths = st.sampled_from(
    ("", ".", "/", "nowhere", "/dev/zero", "a\nb\x1b[31m", "\udcff", "x" * 5000, "epuck", "-")
)


def _leaves(command: Any, *path: str) -> Iterator[tuple[tuple[str, ...], list[str]]]:
    """The commands below one, each with its options."""
    for name, one in getattr(command, "commands", {}).items():
        yield from _leaves(one, *path, name)
    if path and not hasattr(command, "commands"):
        yield path, [option for one in command.params for option in one.opts if option[0] == "-"]


COMMANDS = list(_leaves(typer.main.get_command(app)))


@st.composite
def words(draw: st.DrawFn) -> list[str]:
    """A command with words that may suit it."""
    command, own = draw(st.sampled_from(COMMANDS))
    given = [*command, *draw(st.lists(paths, max_size=2))]
    for option in draw(st.lists(st.sampled_from([*own, "--help", "--nix"]), max_size=4)):
        given += [option, *draw(st.lists(numbers | paths | specs, min_size=0, max_size=1))]
    return given


def test_words_on_the_command_line_are_taken_or_refused(
    child: Child, count: Counter[str], tmp_path: Path
) -> None:
    @budget
    @given(given=words())
    def holds(given: list[str]) -> None:
        whole = [*given, "--out", str(tmp_path / "nothing" / "x.parquet")]
        check(child, "command line", whole, count)
        if given[0] == "rules":  # needs nothing but somewhere to write
            shutil.rmtree(tmp_path / "nothing", ignore_errors=True)
        assert not (tmp_path / "nothing").exists() or not any((tmp_path / "nothing").iterdir())

    holds()


@pytest.mark.parametrize("what", CORPUS)
def test_what_was_once_found_is_read_or_refused(what: str, tmp_path: Path, child: Child) -> None:
    reader, name, content = CORPUS[what]
    ended = child.read(reader, laid_out(tmp_path, reader, name, content()))
    assert ended.how == "refused", ended


@pytest.mark.slow
def test_a_packed_log_of_eight_gigabytes_is_refused(tmp_path: Path, child: Child) -> None:
    reader, name, content = SLOW
    ended = child.read(reader, laid_out(tmp_path, reader, name, content()))
    assert ended.how == "refused", ended


@pytest.mark.parametrize("what", LOGS)
def test_logs_that_were_once_found_are_read_or_refused(
    what: str, tmp_path: Path, child: Child
) -> None:
    reader, change = LOGS[what]
    name = READERS[reader].table
    content = WRITERS[Path(name).suffix](change(table_of(reader)))
    ended = child.read(reader, laid_out(tmp_path, reader, name, content))
    assert ended.how in ("value", "refused"), ended


@pytest.mark.parametrize("text", SPECS)
def test_specs_that_were_once_found_are_refused(text: str, child: Child) -> None:
    assert child.read("SPEC", text).how == "refused"


@pytest.mark.parametrize("given", WORDS, ids=" ".join)
def test_words_that_were_once_found_are_refused(given: list[str], child: Child) -> None:
    assert child.read("command line", given).how == "refused"
