import gzip

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.log import table_files
from realitygap.models.log.table_files import read_csv, read_parquet
from tests.models.small import driven_log


def refusal(read, *given, **named):
    with pytest.raises(InputError) as caught:
        read(*given, "a table", **named)
    return str(caught.value)


def test_a_packed_log_is_the_log(tmp_path):
    frame = driven_log(1, rows=3000)
    frame.to_csv(tmp_path / "a.csv", index=False)
    frame.to_csv(tmp_path / "a.csv.gz", index=False)
    assert (tmp_path / "a.csv").stat().st_size > 4 * table_files.HEAD
    plain = read_csv(tmp_path / "a.csv", "a table", packed=False)
    pd.testing.assert_frame_equal(plain, pd.read_csv(tmp_path / "a.csv"))
    packed = read_csv(tmp_path / "a.csv.gz", "a table", packed=True)
    pd.testing.assert_frame_equal(plain, packed)


def test_a_parquet_log_is_what_was_written(tmp_path):
    frame = driven_log(1, rows=300).assign(case=pd.Categorical(["no-light"] * 600), food=True)
    frame.loc[3, "case"] = None
    frame.to_parquet(tmp_path / "a.parquet")
    back = read_parquet(tmp_path / "a.parquet", "a table")
    pd.testing.assert_frame_equal(back, frame.astype({"case": "str"}), check_dtype=False)


def test_an_index_is_a_column_like_others(tmp_path):
    frame = driven_log(1, rows=30).set_index("t")
    frame.to_parquet(tmp_path / "a.parquet")
    assert "t" in read_parquet(tmp_path / "a.parquet", "a table")


def test_of_lists_only_the_name_is_read(tmp_path):
    frame = driven_log(1, rows=30).assign(ranges=[[1.0, 2.0]] * 60)
    frame.to_parquet(tmp_path / "a.parquet")
    back = read_parquet(tmp_path / "a.parquet", "a table")
    assert back["ranges"].isna().all()
    assert len(back) == 60


@pytest.mark.parametrize("packed", [False, True])
def test_a_csv_ends_at_its_limits(tmp_path, monkeypatch, packed):
    path = tmp_path / "a.csv"
    text = b"a,b\n" + b"1,2\n" * 200_000
    path.write_bytes(gzip.compress(text) if packed else text)
    assert len(read_csv(path, "a table", packed=packed)) == 200_000
    monkeypatch.setattr(table_files, "MOST_CELLS", 300_000)
    assert "300000 numbers" in refusal(read_csv, path, packed=packed)
    monkeypatch.undo()
    monkeypatch.setattr(table_files, "MOST_BYTES", 400_000)
    assert "400000" in refusal(read_csv, path, packed=packed)


def test_short_rows_count_as_whole_ones(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_bytes(b",".join(b"c%d" % k for k in range(100)) + b"\n" + b"1\n" * 20_000)
    monkeypatch.setattr(table_files, "MOST_CELLS", 1_000_000)
    assert "1000000 numbers" in refusal(read_csv, path, packed=False)


def test_columns_without_a_name_count(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"a\n" + b"1," * 2000 + b"1\n")
    assert "columns" in refusal(read_csv, path, packed=False)


def test_a_header_without_end_is_refused(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"x" * 10_000_000)
    assert "a line of" in refusal(read_csv, tmp_path / "a.csv", packed=False)


def test_a_parquet_is_judged_by_its_metadata(tmp_path, monkeypatch):
    driven_log(1, rows=1000).to_parquet(tmp_path / "a.parquet")
    monkeypatch.setattr(table_files, "MOST_CELLS", 15_000)
    assert "15000 numbers" in refusal(read_parquet, tmp_path / "a.parquet")
    monkeypatch.undo()
    monkeypatch.setattr(table_files, "MOST_COLUMNS", 5)
    assert "columns" in refusal(read_parquet, tmp_path / "a.parquet")


def test_a_text_that_repeats_is_judged_by_what_it_takes(tmp_path, monkeypatch):
    text = pa.DictionaryArray.from_arrays(
        pa.array(np.zeros(1000, np.int32)), pa.array(["x" * 5000])
    )
    pq.write_table(pa.table({"run": text}), tmp_path / "a.parquet")
    assert (read_parquet(tmp_path / "a.parquet", "a table")["run"] == "x" * 5000).all()
    monkeypatch.setattr(table_files, "MOST_BYTES", 4_000_000)
    assert "4000000 bytes" in refusal(read_parquet, tmp_path / "a.parquet")
