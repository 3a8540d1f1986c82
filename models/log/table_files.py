"""Tables as files: Parquet, CSV and packed CSV, read within stated limits.

A few packed bytes can stand for any number of cells. What a file unpacks to is told from its
metadata, or counted while it streams, before it is held.

How a table is written as text is read off its first lines. The separator is the one of semicolon,
tab, comma and blanks that divides the header and the first row into equally many parts. The decimal
sign is a comma if some number of the first rows has one and none has a point.
"""

from __future__ import annotations

import csv
import gzip
import io
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from realitygap.embedded_sim import InputError
from realitygap.models.log.opened import opened, parsing

BLANKS = r"\s+"
"""As pandas takes white space of any length."""
ROWS = 50
"""Rows whose numbers are looked at. Our choice: a table of whole numbers alone has no sign."""
_COMMA = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?")
_POINT = re.compile(r"[+-]?\d*\.\d+(?:[eE][+-]?\d+)?")


class Dialect(NamedTuple):
    """One way of writing."""

    separator: str = ","
    decimal: str = "."


def dialect(head: bytes) -> Dialect:
    """The dialect of a table by its first bytes; the usual one where they do not tell."""
    lines = [line for line in head.decode("utf-8-sig", "replace").splitlines() if line.strip()]
    first = lines[: ROWS + 1]
    separator = next((s for s in (";", "\t", ",", BLANKS) if _divides(first[:2], s)), ",")
    cells = [cell.strip() for line in first[1:] for cell in _cells(line, separator)]
    comma = any(_COMMA.fullmatch(cell) for cell in cells)
    point = any(_POINT.fullmatch(cell) for cell in cells)
    return Dialect(separator, "," if comma and not point else ".")


def _divides(lines: list[str], separator: str) -> bool:
    """Whether a separator makes of every line the same number of cells, and more than one."""
    widths = {len(_cells(line, separator)) for line in lines}
    return len(widths) == 1 and widths.pop() > 1


def _cells(line: str, separator: str) -> list[str]:
    if separator == BLANKS:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:  # a field longer than any number, a NUL
        return []


if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

MOST_BYTES = 2**30
"""bytes of a table, unpacked: a CSV of `MOST_CELLS` short numbers."""
MOST_CELLS = 100_000_000
"""Rows times columns; 0.8 GB as numbers. Our choice: three hours of ten robots with every sensor at
25 Hz. A longer log is given in parts."""
MOST_COLUMNS = 1000
"""Our choice: thirty times those of the measured log."""
HEAD = 2**16
"""bytes that a CSV's header and first row lie in: 64 letters a column at most columns."""
_UNNAMED = re.compile(r"__index_level_\d+__")
"""What pandas calls an index without a name."""
RECORDER = b"recorder"
"""Key of a Parquet file's metadata: what recorded it, in one word and its rows' step in s."""
LESS = "a smaller table: give a long log in parts"


def read_parquet(path: Path, expected: str) -> pd.DataFrame:
    """A Parquet file as a table; of a column of lists or records only the name.

    Args:
        path: The file.
        expected: What it should be, in a refusal.

    Raises:
        InputError: it cannot be read, or holds more than the limits of this module.
    """
    with opened(path, expected, most=MOST_BYTES) as file, parsing(str(path), expected):
        whole = pq.ParquetFile(file)
        schema, about = whole.schema_arrow, whole.metadata
        size = sum(about.row_group(k).total_byte_size for k in range(about.num_row_groups))
        _check(path, about.num_rows, about.num_columns, size)
        nested = [field.name for field in schema if pa.types.is_nested(field.type)]
        texts = [field.name for field in schema if _is_text(field.type)]
        flat = [name for name in schema.names if name not in nested] if nested else None
        # a text that repeats is held once, as in the file
        table = pq.ParquetFile(file, read_dictionary=texts).read(columns=flat)
        # what pandas noted beside the columns is not needed: an index is a column like others
        frame: pd.DataFrame = _spelt_out(path, table).to_pandas(ignore_metadata=True)
        frame = frame.drop(columns=[name for name in frame if _UNNAMED.fullmatch(str(name))])
        frame = frame.assign(**dict.fromkeys(nested)) if nested else frame
        recorder = (schema.metadata or {}).get(RECORDER)
        if recorder is not None:
            frame.attrs["recorder"] = recorder.decode("utf-8", "replace")
        return frame


def read_csv(path: Path, expected: str, *, packed: bool) -> pd.DataFrame:
    """A CSV file as a table, in the dialect that its first lines show (`log.dialect`).

    Args:
        path: The file.
        expected: What it should be, in a refusal.
        packed: With gzip.

    Raises:
        InputError: it cannot be read, or holds more than the limits of this module.
    """
    with opened(path, expected, most=MOST_BYTES) as file, parsing(str(path), expected):
        source: Any = gzip.GzipFile(fileobj=file) if packed else file
        head = source.read(HEAD)
        written = dialect(head)
        width = _width(path, head, written)
        source.seek(0)
        stream = _Counted(path, source, width)
        try:
            return _parsed(io.BufferedReader(stream, HEAD), written)
        except Exception:
            if stream.refusal is not None:  # the parser hides why its source failed
                raise stream.refusal from None
            raise


class _Counted(io.RawIOBase):
    """A source that ends with a refusal where the limits are reached."""

    def __init__(self, path: Path, source: BinaryIO, width: int) -> None:
        self._path, self._source, self._width = path, source, width
        self._bytes = self._feeds = self._returns = 0
        self.refusal: InputError | None = None

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        space = memoryview(buffer)
        data = self._source.read(len(space))
        space[: len(data)] = data
        self._bytes += len(data)
        self._feeds += data.count(b"\n")
        self._returns += data.count(b"\r")
        try:
            _check(self._path, max(self._feeds, self._returns), self._width, self._bytes)
        except InputError as refusal:
            self.refusal = refusal
            raise
        return len(data)


def _check(path: Path, rows: int, columns: int, size: int) -> None:
    """Refuse more than the limits."""
    if columns > MOST_COLUMNS:
        raise InputError(str(path), f"{columns} columns", f"at most {MOST_COLUMNS}")
    if rows * columns > MOST_CELLS:
        raise InputError(str(path), f"more than {MOST_CELLS} numbers", LESS)
    if size > MOST_BYTES:
        raise InputError(str(path), f"more than {MOST_BYTES} bytes unpacked", LESS)


def _width(path: Path, head: bytes, written: Dialect) -> int:
    """Columns of a CSV by its header and first rows, those that pandas takes for an index too."""
    if len(head) == HEAD:
        head = head[: max(head.rfind(b"\n"), head.rfind(b"\r")) + 1]
        if not head:
            raise InputError(str(path), f"a line of {HEAD} bytes or more", "a table")
    first = _parsed(io.BytesIO(head), written, nrows=1)
    named = 0 if isinstance(first.index, pd.RangeIndex) else first.index.nlevels
    width = len(first.columns) + named
    _check(path, 0, width, 0)
    return width


def _parsed(source: io.BufferedIOBase, written: Dialect, nrows: int | None = None) -> pd.DataFrame:
    with warnings.catch_warnings():
        # a column of numbers and texts is judged where it is known what it should be
        warnings.simplefilter("ignore", pd.errors.DtypeWarning)
        return pd.read_csv(
            source,
            sep=written.separator,
            decimal=written.decimal,
            skipinitialspace=True,
            nrows=nrows,
        )


def _is_text(kind: Any) -> bool:
    """Whether values are texts or bytes of any length."""
    texts = (pa.types.is_string, pa.types.is_large_string, pa.types.is_string_view)
    raw = (pa.types.is_binary, pa.types.is_large_binary, pa.types.is_binary_view)
    return any(one(kind) for one in (*texts, *raw))


def _spelt_out(path: Path, table: Any) -> Any:
    """A table whose texts stand in every row, if they are not too long for that."""
    size = 0
    for k, field in enumerate(table.schema):
        if not (pa.types.is_dictionary(field.type) and _is_text(field.type.value_type)):
            continue
        for chunk in table.column(k).chunks:
            lengths = pc.take(pc.binary_length(chunk.dictionary), chunk.indices)
            size += pc.sum(lengths.cast(pa.int64())).as_py() or 0
            _check(path, 0, 0, size)
        kind = field.type.value_type
        table = table.set_column(k, field.with_type(kind), table.column(k).cast(kind))
    return table
