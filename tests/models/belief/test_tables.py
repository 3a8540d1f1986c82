from dataclasses import fields, replace

import numpy as np
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.belief.tables import load_tables, save_tables
from tests.models.small import tables


def test_tables_come_back_as_they_were_written(tmp_path):
    save_tables(tables(), tmp_path / "t.npz")
    back = load_tables(tmp_path / "t.npz")
    for field in fields(back):
        written, read = getattr(tables(), field.name), getattr(back, field.name)
        assert np.array_equal(written, read), field.name
        assert np.asarray(written).dtype == np.asarray(read).dtype, field.name


def test_the_same_tables_give_the_same_bytes(tmp_path):
    for name in ("a.npz", "b.npz"):
        save_tables(tables(), tmp_path / name)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_the_file_says_the_unit_of_every_member(tmp_path):
    save_tables(tables(), tmp_path / "t.npz")
    with np.load(tmp_path / "t.npz") as archive:
        about = str(archive["about"])
        assert all(name in about for name in archive.files if name != "about")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 not an archive", b"text"])
def test_a_file_that_is_no_table_is_refused(tmp_path, content):
    (tmp_path / "t.npz").write_bytes(content)
    with pytest.raises(InputError, match="capture"):
        load_tables(tmp_path / "t.npz")


@pytest.mark.parametrize(
    "change",
    [
        {"ps_counts": np.zeros((7, 9, 5), np.float32)},
        {"ps_counts": np.zeros((8, 1, 5), np.float32)},
        {"ls_counts": np.full((9, 24), np.nan, np.float32)},
        {"ps_range": 0.0},
        {"ls_dark": -1.0},
    ],
)
def test_values_no_sensor_can_have_are_refused(tmp_path, change):
    save_tables(replace(tables(), **change), tmp_path / "t.npz")
    with pytest.raises(InputError, match=next(iter(change))):
        load_tables(tmp_path / "t.npz")
