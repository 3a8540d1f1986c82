import dataclasses
import os
import shlex
import subprocess
from pathlib import Path

from hypothesis import example, given, settings
from hypothesis import strategies as st

from realitygap.studies.diagnosis.request import Request
from realitygap.studies.gain.request import GainRequest
from realitygap.studies.health.reference import ReferenceRequest
from realitygap.studies.inputs.logs import sources
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.typed import typed

names = st.binary(min_size=1, max_size=20).filter(lambda raw: b"\0" not in raw).map(os.fsdecode)


def as_bash_takes(line):
    """The words that a shell makes of a line."""
    script = f"printf '%s\\0' {line}"
    shell = ["bash", "-c", script]
    done = subprocess.run(shell, env={"LC_ALL": "C.UTF-8"}, capture_output=True, check=True)
    return [os.fsdecode(word) for word in done.stdout.split(b"\0")[:-1]]


@settings(max_examples=30, deadline=None)
@given(
    st.lists(names | st.text(st.characters(blacklist_characters="\0", codec="utf-8")), min_size=1)
)
@example(["\x012"])  # an escape before what could be its next digit
def test_a_shell_takes_typed_words_as_they_were(words):
    line = typed(*words)
    assert line.isprintable()
    assert as_bash_takes(line) == words


def test_a_path_that_begins_with_a_dash_is_no_option():
    assert typed("gap", Path("-a.csv")) == "gap ./-a.csv"


def called(name):
    """A model that was given by this name."""
    return dataclasses.replace(Model.load(), given=name)


def test_commands_kept_in_files_are_quoted():
    path, mine = Path("two words;rm -rf $HOME\n.csv"), called("my robot.toml")
    odd = sources(path)
    requests = (
        Request(logs=odd, model=mine, reference="a b.json", without=("x y",)),
        GainRequest(logs=odd, extended=mine, healthy=odd),
        ReferenceRequest(logs=odd, model=mine),
    )
    for request in requests:
        words = as_bash_takes(request.command)
        assert str(path) in words
        assert "my robot.toml" in words


def test_plain_commands_look_as_before():
    logs = sources("out/a")
    request = Request(logs=logs, model=called("create"), seed=3, without=("motor_lag",))
    expected = "realitygap diagnose out/a --model create --seed 3 --without motor_lag"
    assert request.command == expected
    assert shlex.split(request.command) == expected.split()
