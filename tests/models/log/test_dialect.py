"""Tables as other programs write them."""

from __future__ import annotations

import pandas as pd
import pytest

from realitygap.models.log.table_files import BLANKS, Dialect, dialect, read_csv
from tests.models.small import driven_log

LOG = driven_log(1, rows=60).drop(columns="run")


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_every_separator_and_decimal_sign_gives_the_same_table(tmp_path, separator, decimal):
    path = tmp_path / "log.csv"
    LOG.to_csv(path, index=False, sep=separator, decimal=decimal)
    pd.testing.assert_frame_equal(read_csv(path, "a table", packed=False), LOG)


def test_blanks_may_be_many_and_stand_before_the_first_column(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(LOG.to_string(index=False, float_format="%.9f"))
    read = read_csv(path, "a table", packed=False)
    pd.testing.assert_frame_equal(read, LOG, atol=1e-8)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("t,x\n0.1,2", Dialect()),
        ("t;x, m\n0,1;2", Dialect(";", ",")),
        ("stamp,note\n2024-01-01 12:00:00,all is well", Dialect()),
        ("time stamp;x\n1;2", Dialect(";", ".")),
        ('t,x\n"0,1","2,5"', Dialect(",", ",")),
        ('a,b\n"1,2",0.5', Dialect()),
        ("t  x\n0  1", Dialect(BLANKS, ".")),
        ("t\n1", Dialect()),
        ("", Dialect()),
    ],
)
def test_the_dialect_is_read_off_the_first_lines(text, found):
    assert dialect(text.encode()) == found
