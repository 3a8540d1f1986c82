"""Logs as they are kept: rounded where nothing is lost, so that all of them stay small."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from realitygap.models.log.table_files import RECORDER
from realitygap.studies.blind.record import record
from realitygap.studies.plumbing.rooms import scratch
from tests.golden.plan import ALL, plan

POSE = ("x", "y", "yaw")
COMMANDS = ("cmd_left", "cmd_right")
STEPS = {"pose": 2.0**-16, "wheels": 2.0**-10}
"""m and rad: 15 millionths, of noise 30 times as large; rad/s. Powers of two leave zeros."""
LEVEL = 19
"""Of zstd, of 22: more gains nothing."""


def make(name: str) -> bytes:
    """Record a log of the plan as it is kept. Executed by a worker."""
    kept = plan()[name]
    with scratch() as room:
        record(kept.trial.run, kept.trial.specs, room / "log.parquet")
        table = packed(pd.read_parquet(room / "log.parquet"), kept.columns)
        recorder = pq.read_schema(room / "log.parquet").metadata[RECORDER]
        write(table, room / "packed.parquet", recorder)
        return (room / "packed.parquet").read_bytes()


def packed(log: pd.DataFrame, columns: tuple[str, ...]) -> pd.DataFrame:
    """A log with some of its columns, numbers rounded."""
    log = log.drop(columns=[name for name in ALL if name not in columns])
    log = log.sort_values(["robot", "t"], ignore_index=True)
    wheels = [name for name in (*COMMANDS, "wheel_left", "wheel_right") if name in log]
    for names, step in ((POSE, STEPS["pose"]), (wheels, STEPS["wheels"])):
        for name in names:
            log[name] = (np.round(log[name] / step) * step).astype(np.float32)
    return log


def write(table: pd.DataFrame, path: Path, recorder: bytes) -> None:
    """As Parquet, bytes of numbers side by side, with what recorded it."""
    rounded = [str(name) for name in table if table[name].dtype == np.float32]
    pq.write_table(
        pa.Table.from_pandas(table, preserve_index=False).replace_schema_metadata(
            {RECORDER: recorder}
        ),
        path,
        compression="zstd",
        compression_level=LEVEL,
        use_dictionary=[str(name) for name in table if name not in rounded],
        use_byte_stream_split=rounded,
    )
