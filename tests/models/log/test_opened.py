import os

import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.tables import load_tables
from realitygap.models.log.measured import read_table
from realitygap.models.log.opened import DEEPEST, MOST_TOML, opened, parsing, toml_values
from realitygap.models.naming.health.reference import read_reference

READERS = {
    ".toml": read_model_file,
    ".csv": read_table,
    ".csv.gz": read_table,
    ".parquet": read_table,
    ".json": read_reference,
    ".npz": load_tables,
}


def refusal(read, path):
    with pytest.raises(InputError) as caught:
        read(path)
    return str(caught.value)


@pytest.mark.parametrize("suffix", READERS)
def test_a_pipe_is_refused_at_once(tmp_path, suffix):
    path = tmp_path / f"pipe{suffix}"
    os.mkfifo(path)
    assert "no regular file" in refusal(READERS[suffix], path)


@pytest.mark.parametrize("suffix", READERS)
def test_an_endless_device_is_not_read(tmp_path, suffix):
    path = tmp_path / f"zero{suffix}"
    path.symlink_to("/dev/zero")
    assert "no regular file" in refusal(READERS[suffix], path)


@pytest.mark.parametrize("suffix", READERS)
def test_a_directory_in_place_of_a_file_is_refused(tmp_path, suffix):
    path = tmp_path / f"directory{suffix}"
    path.mkdir()
    assert "directory" in refusal(READERS[suffix], path)


@pytest.mark.parametrize("suffix", READERS)
def test_an_absent_file_is_refused(tmp_path, suffix):
    refusal(READERS[suffix], tmp_path / f"absent{suffix}")
    refusal(READERS[suffix], tmp_path / f"{'x' * 300}{suffix}")
    refusal(READERS[suffix], tmp_path / "no\0name" / f"x{suffix}")


@pytest.mark.parametrize("suffix", READERS)
def test_a_file_that_may_not_be_read_is_refused(tmp_path, monkeypatch, suffix):
    def closed(*_):
        raise PermissionError(13, "Permission denied")

    (tmp_path / f"closed{suffix}").touch()
    monkeypatch.setattr(os, "open", closed)  # no mode keeps root from reading
    assert "Permission denied" in refusal(READERS[suffix], tmp_path / f"closed{suffix}")


def test_a_file_is_measured_before_it_is_read(tmp_path):
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.truncate(MOST_TOML + 1)  # takes no room on the disk
    assert f"{MOST_TOML + 1} bytes" in refusal(read_model_file, path)


def test_no_file_stays_open_after_a_refusal(tmp_path):
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(5):
        with pytest.raises(InputError), opened(tmp_path, "a file", most=1):
            pass
    assert len(os.listdir("/proc/self/fd")) == before


@pytest.mark.parametrize(
    "raised", [RecursionError(), KeyError("x"), MemoryError(), OSError(5, "no")]
)
def test_whatever_a_parser_raises_becomes_a_refusal(raised):
    with pytest.raises(InputError, match=r"x: got .+, expected y"), parsing("x", "y"):
        raise raised


def test_a_refusal_and_an_interrupt_pass_a_parser_unchanged():
    with pytest.raises(InputError, match="own: got"), parsing("x", "y"):
        raise InputError("own", 1, "2")
    with pytest.raises(KeyboardInterrupt), parsing("x", "y"):
        raise KeyboardInterrupt


@pytest.mark.parametrize(
    "part",
    ["a", '"a"', "'a'", r'"\"."', "a-b_1"],
    ids=["bare", "basic", "literal", "escape", "dash"],
)
def test_a_key_of_many_parts_is_refused_before_it_costs_its_square(tmp_path, part):
    path = tmp_path / "deep.toml"
    path.write_text(".".join([part] * DEEPEST) + ".x = 1\n")
    assert "parts" in refusal(lambda p: toml_values(p, "TOML"), path)


def test_texts_and_numbers_with_many_dots_are_no_deep_keys(tmp_path):
    path = tmp_path / "dots.toml"
    logs = " ".join(f"out/run{k}.v1.csv" for k in range(200))
    path.write_text(f'command = "realitygap diagnose {logs} a.b.c.d"\nx = {[0.5] * 100}\n')
    assert len(toml_values(path, "TOML")["x"]) == 100
