"""What once ended in a traceback, a hang or an allocation without bounds, as what makes it."""

from __future__ import annotations

import gzip
import io
import zipfile
from collections.abc import Callable

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from tests.fuzz.labs import MAP
from tests.fuzz.readers import READERS

Content = Callable[[], bytes]


def _npy(shape: str) -> bytes:
    """An array whose header promises a shape."""
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}"
    padded = header.ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(padded).to_bytes(2, "little") + padded.encode() + b"\0" * 64


def _archive(ps_counts: bytes, compression: int = zipfile.ZIP_STORED) -> bytes:
    """The shipped tables with another member."""
    out = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(READERS["sensor tables"].files()["epuck.npz"])) as sound,
        zipfile.ZipFile(out, "w", compression) as archive,
    ):
        for name in sound.namelist():
            archive.writestr(name, ps_counts if name == "ps_counts.npy" else sound.read(name))
    return out.getvalue()


def _plain_array() -> bytes:
    out = io.BytesIO()
    np.save(out, np.zeros(3))
    return out.getvalue()


def _packed(part: bytes, times: int, head: bytes = b"") -> bytes:
    """A packed text of any length out of few bytes: packed parts may follow one another."""
    return gzip.compress(head, 1) + gzip.compress(part, 9) * times


def _model(text: str) -> Content:
    return lambda: READERS["model"].files()["model.toml"] + text.encode()


def _repeated_text() -> bytes:
    """A text of 200 000 letters in each of 20 000 rows, held once: 4 GB out of 2 kB."""
    rows = 20_000
    index = pa.array(np.zeros(rows, dtype=np.int32))
    text = pa.DictionaryArray.from_arrays(index, pa.array(["x" * 200_000]))
    out = io.BytesIO()
    pq.write_table(pa.table({"run": text, "t": np.arange(rows) * 0.04}), out)
    return out.getvalue()


CORPUS: dict[str, tuple[str, str, Content]] = {
    "deep nesting in a model": ("model", "model.toml", _model("\nx = " + "[" * 5000)),
    "an integer of 5000 digits in a model": ("model", "model.toml", _model("\nx = " + "9" * 5000)),
    "a hexadecimal integer of 5000 digits in a model": (
        *("model", "model.toml"),
        lambda: b"name = 0x" + b"f" * 5000,
    ),
    "a key of 100000 parts in a model": (
        "model",
        "model.toml",
        _model("\n" + "a." * 100_000 + "a=1"),
    ),
    "deep nesting in a map": ("map", "map.toml", lambda: MAP.encode() + b"\nx=" + b"[" * 5000),
    "a map of a directory": ("map", "map.toml", lambda: MAP.replace("poses.csv", ".").encode()),
    "a map of a device": (
        "map",
        "map.toml",
        lambda: MAP.replace("poses.csv", "/dev/zero").encode(),
    ),
    "a map of a NUL": ("map", "map.toml", lambda: MAP.replace("poses.csv", r"\u0000.csv").encode()),
    "deep nesting in a reference": ("reference", "r.json", lambda: b"[" * 100_000),
    "an integer of 5000 digits in a reference": ("reference", "r.json", lambda: b"9" * 5000),
    "a reference with a coordinate too many": (
        *("reference", "r.json"),
        lambda: (
            READERS["reference"].files()["r.json"].replace(b'"inherent": [', b'"inherent": [1,')
        ),
    ),
    "a reference of NaN": (
        *("reference", "r.json"),
        lambda: (
            READERS["reference"].files()["r.json"].replace(b'"mean": ', b'"mean": NaN, "x":', 1)
        ),
    ),
    "a plain array as tables": ("sensor tables", "epuck.npz", _plain_array),
    "tables whose header promises a terabyte": (
        *("sensor tables", "epuck.npz"),
        lambda: _archive(_npy("(8, 200000, 200000)")),
    ),
    "tables whose header promises more than a number holds": (
        *("sensor tables", "epuck.npz"),
        lambda: _archive(_npy(f"(8, {2**62}, {2**62})")),
    ),
    "tables that unpack to a thousand times their size": (
        *("sensor tables", "epuck.npz"),
        lambda: _archive(_npy("(8, 2200, 2200)") + b"\0" * 155_000_000, zipfile.ZIP_DEFLATED),
    ),
    "a packed log of two thousand million short rows": (
        *("packed csv", "log.csv.gz"),
        lambda: _packed(b"0\n" * 2**20, 1000, b",".join(b"c%d" % k for k in range(900)) + b"\n0\n"),
    ),
    "a packed log of 9000 columns": (
        *("packed csv", "log.csv.gz"),
        lambda: _packed(b"0\n", 9, b"," * 9000 + b"\n"),
    ),
    "a packed log with a byte flipped": (
        *("packed csv", "log.csv.gz"),
        lambda: (
            bytes([*(d := READERS["packed csv"].files()["log.csv.gz"])[:200], d[200] ^ 255])
            + d[201:]
        ),
    ),
    "a Parquet log whose text repeats": ("parquet", "log.parquet", _repeated_text),
    "an empty log": ("csv", "log.csv", lambda: b""),
    "a log of UTF-16": (
        "csv",
        "log.csv",
        lambda: READERS["csv"].files()["log.csv"].decode().encode("utf-16"),
    ),
    "a truth of another shape": (
        "truth",
        "truth.json",
        lambda: b'{"effects": [{"name": "motor_lag"}]}',
    ),
    "a truth out of bounds": (
        *("truth", "truth.json"),
        lambda: READERS["truth"].files()["truth.json"].replace(b"0.1", b"1e9"),
    ),
    "a run.json of a list": ("run.json", "run.json", lambda: b"[]"),
    "a transfer.json without labels": (
        *("transfer", "transfer.json"),
        lambda: b'{"schema": 1, "configuration": {}, "alterations": [1]}',
    ),
    "poses without any yaw": (
        *("mapped csv", "poses.csv"),
        lambda: b"when,px,py,heading,id\n" + b"".join(b"%d,1,2,,0\n" % k for k in range(40)),
    ),
    "commands that are text": (
        *("mapped csv", "lab.csv"),
        lambda: (
            READERS["mapped csv"]
            .files()["lab.csv"]
            .replace(b",True", b",True")
            .replace(b"0.0,", b"a,", 1)
        ),
    ),
}
"""Reader, file and content: each is refused."""

SLOW: tuple[str, str, Content] = (
    *("packed csv", "log.csv.gz"),
    lambda: _packed(b"\0" * 2**23, 1000, b"a\n"),
)
"""A packed log of 8 GB: a whole GiB is unpacked before it is refused."""

LOGS: dict[str, tuple[str, Callable[[pd.DataFrame], pd.DataFrame]]] = {
    "robot 10**400": ("csv", lambda f: f.assign(robot=[10**400] * len(f))),
    "one robot 10**400": ("csv", lambda f: f.assign(robot=[*f["robot"][1:], 10**400])),
    "an empty case": ("parquet", lambda f: f.assign(case="")),
    "a constant food of text": ("parquet", lambda f: f.assign(food="\x1b[31m")),
    "a constant sensor of a date": ("parquet", lambda f: f.assign(ps0=pd.Timestamp(0))),
    "lists in a column of its own": ("parquet", lambda f: f.assign(ranges=[[1.0]] * len(f))),
    "lists in a sensor": ("parquet", lambda f: f.assign(ps0=[[1.0]] * len(f))),
    "records in a robot": ("parquet", lambda f: f.assign(robot=[{"a": 1}] * len(f))),
    "infinite generations": ("generations", lambda f: f.assign(fitness_sim=np.inf)),
    "generations without a run": ("generations", lambda f: f.assign(run=None)),
    "generations of text": ("generations", lambda f: f.assign(t_end="x")),
    "generations without a robot": ("generations", lambda f: f.assign(robot=np.nan)),
}
"""Reader, and the change of its sound table."""

SPECS = (
    "motor_lag:time_constant=0.1,robot=" + "9" * 5000,
    "motor_lag:time_constant=nan",
    "motor_lag:time_constant=" + "9" * 5000,
    "\x1b[31m\n",
    "motor_lag:time_constant=0.1,robot=-1",
    "motor_lag:time_constant=0.1,robot=²",
)

WORDS = [
    ["diagnose", "a.csv", "--seed", "-1", "--out", "nothing"],
    ["diagnose", "a.csv", "--seed", "9" * 30, "--out", "nothing"],
    ["reference", "--runs", "1", "--seed", "-1", "--out", "nothing"],
    ["reference", "--runs", "1" + "0" * 400, "--out", "nothing"],
    ["run", "--minutes", "nan", "--out", "nothing"],
    ["run", "--minutes", "inf", "--out", "nothing"],
    ["run", "--robots", "0", "--out", "nothing"],
    ["run", "--robots", "1" + "0" * 400, "--out", "nothing"],
    ["blind", "--trials", "1" + "0" * 400, "--out", "nothing"],
    ["blind", "--seconds", "nan", "--out", "nothing"],
    ["demo", "--jobs", "1" + "0" * 400, "--out", "nothing"],
    ["gap", "/dev/zero", "--out", "nothing"],
]
