"""Logs of the OptiOdom data set (Sousa, Petry, Costa, Moreira, J. Intell. Robot. Syst. 2022).

A session is a directory `<id>/` with `<id>.csv` (the robot's own log: wheel ticks and commands, the
runs one after the other) and `<id>_run-NN.csv` (poses of an OptiTrack system with the ticks they
were synchronised by); `<id>_run-NN_odo.csv` and `_opti.csv` beside them are not read. A pose row is
joined to a command row through their same sequence of ticks: nothing is interpolated. The authors
synchronised by hand: delays below a cycle mean nothing.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.log.formats.numbers import numbers, read_numbers, read_plain

CYCLE = 0.05
"""s, the robot's control cycle (20 Hz)."""
TICKS_PER_TURN = 64 * 43.7
"""Encoder ticks per wheel revolution: 64 per motor revolution, gear 43.7 (session metadata)."""

PAIR = 16
"""bytes of the ticks of two wheels."""

Array = npt.NDArray[np.float64]


def read_optiodom(directory: Path, *, drive: Drive) -> pd.DataFrame:
    """The session (or every session below a directory) as a measured-log table.

    Commands become `cmd_v` (ticks/cycle through the wheel's radius) and `cmd_omega`; encoder speeds
    are means over the cycle that ends at the row.

    Args:
        directory: `<id>/`, or a directory above several of them.
        drive: The nominal geometry.

    Raises:
        InputError: not such a directory, or a file in it cannot be read or matched.
    """
    sessions = sorted(path.parent for path in directory.glob("**/*_run-01.csv"))
    if not sessions:
        raise InputError("SOURCE", directory, "a directory with <id>.csv and <id>_run-01.csv ...")
    return pd.concat([_session(path, drive) for path in sessions], ignore_index=True)


def _session(directory: Path, drive: Drive) -> pd.DataFrame:
    """One session, its runs named `<id>/NN`."""
    name = directory.name
    logged = _robot_log(directory / f"{name}.csv")
    metre = np.pi * sum(drive.wheel_radius) / TICKS_PER_TURN
    runs = []
    for path in sorted(directory.glob(f"{name}_run-*.csv")):
        if not re.fullmatch(r"run-\d+", path.stem.removeprefix(f"{name}_")):
            continue  # the authors' intermediate files lie beside them: _odo, _opti
        truth = read_numbers(path, 6, "the poses of a run", delimiter=",")
        rows = _match(logged, truth[:, [5, 4]], path)
        ticks = truth[:, [5, 4]] * (2 * np.pi / TICKS_PER_TURN / CYCLE)
        runs.append(
            pd.DataFrame(
                {
                    "run": f"{name}/{path.stem.rsplit('-', 1)[1]}",
                    "robot": 0,
                    "t": truth[:, 0],
                    "x": truth[:, 1],
                    "y": truth[:, 2],
                    "yaw": truth[:, 3],
                    "cmd_v": rows[:, 2] * metre / CYCLE,
                    "cmd_omega": rows[:, 3] / CYCLE,
                    "wheel_left": ticks[:, 0],
                    "wheel_right": ticks[:, 1],
                }
            )
        )
    return pd.concat(runs, ignore_index=True)


def _robot_log(path: Path) -> list[Array]:
    """Per run (cycles, 4): ticks left, ticks right, vlin (ticks/cycle), omega (rad/cycle)."""
    _, *parts = read_plain(path, "the robot's own log").split("Run:")
    runs = []
    for part in parts:
        lines = [line for line in part.splitlines()[1:] if line and line[0] in "-0123456789"]
        values = numbers(lines, path, 8, delimiter=",")
        runs.append(values[:, [1, 2, 6, 7]])
    if not runs:
        raise InputError(str(path), "no line starting with Run:", "command rows after each Run:")
    return runs


def _as_bytes(ticks: Array) -> bytes:
    """(rows, 2) ticks so that equal ones have equal bytes."""
    return np.ascontiguousarray(ticks + 0.0, dtype=np.float64).tobytes()  # -0 becomes 0


def _match(logged: list[Array], ticks: Array, path: Path) -> Array:
    """The robot's rows whose ticks are those of a tracked run, wherever they are."""
    wanted = _as_bytes(ticks)
    for rows in logged:
        there = _as_bytes(rows[:, :2])
        at = there.find(wanted)  # takes time and memory as the rows, not as rows times ticks
        while at >= 0 and at % PAIR:
            at = there.find(wanted, at + 1)
        if at >= 0:
            return rows[at // PAIR :][: len(ticks)]
    raise InputError(
        str(path), f"{len(ticks)} cycles of ticks", "the same ticks in the session's own log"
    )
