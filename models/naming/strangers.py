"""What infrared sees that the log does not have, or misses that the model has.

Far from the wall and from every logged robot infrared reads nothing. Where it often does, in most
robots, somebody is not in the log, or the arena is not the model's; so too where the wall is not
seen where it should be. What sensors read says nothing of sensors then.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS, PointModel, readings
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import sense_causes
from realitygap.models.gap.sensing import measured
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.preflight.entry import PreflightEntry
from realitygap.models.log.schema import LS, PS
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.senses.neighbours import MARGIN, around

MOST_ROWS = 10_000
"""Rows used, evenly in time. No rule: it bounds the work."""
FAR = 10.0
"""Times what readings of nothing scatter, or the floor of their noise, from which on something is
seen. No rule: of 700 000 such readings of ten logs none went so far."""
STRANGE = 0.002
"""Share of a robot's readings of nothing that may be something, for a lost pose.
No rule: one of ten robots that is not logged makes it twice that."""
STRONG, NONE = 200.0, 20.0
"""counts that a wall must be expected to make, and below which it is not seen. No rule: of the
sensor, whose noise there is 20 and 5 counts."""
MISSED = 0.5
"""Share of strong readings that may be missing: a robot alone misses a sixth. No rule: where the
wall is elsewhere nearly all are."""


def without_strangers(
    log: MeasuredLog, model: PointModel
) -> tuple[MeasuredLog, tuple[PreflightEntry, ...]]:
    """A log without readings that say nothing of sensors, and what the pre-flight says of it.

    Args:
        log: In the frame of the model's arena.
        model: What the simulator believes.
    """
    if model.tables is None or not any(name in log.frame for name in PS):
        return log, tuple(_entries(None, None, gone=False))
    rows = np.flatnonzero(log.tracked)
    rows = rows[:: max(1, -(-len(rows) // MOST_ROWS))]
    robot = log.frame["robot"].to_numpy(dtype=np.int64)[rows]
    read, poses = measured(log, rows)[:, :SENSORS], log.poses[rows]
    alone = ~around(log, rows).in_ray(poses, model) & np.isfinite(read)
    seen = _seen(read, alone & _open(poses, model)[:, None], robot, model)
    missed = _missed(read, alone, poses, robot, model)
    gone = (seen or 0.0) > STRANGE or (missed or 0.0) > MISSED
    entries = tuple(_entries(seen, missed, gone=gone))
    if not gone:
        return log, entries
    there = [name for name in (*PS, *LS) if name in log.frame]
    kept = log.frame.drop(columns=there)
    why = (
        "infrared sees what is neither wall nor logged robot"
        if (seen or 0.0) > STRANGE
        else "infrared does not see the wall where the model has it"
    )
    note = f"{why}: infrared and light are not judged; robots may be missing, or the model's arena"
    return replace(log, frame=kept, notes=(*log.notes, note)), (*entries, *_there(there))


def _open(poses: FloatArray, model: PointModel) -> npt.NDArray[np.bool_]:
    """(rows,) so far from the wall that no sensor reaches it, whichever way it looks."""
    assert model.tables is not None
    reach = model.body_radius + model.tables.ps_range + MARGIN
    return np.asarray(np.hypot(poses[:, 0], poses[:, 1]) + reach < model.arena_radius)


def _seen(
    read: FloatArray, alone: npt.NDArray[np.bool_], robot: npt.NDArray[np.int64], model: PointModel
) -> float | None:
    """Share of readings of nothing that are of something, of the middle robot; None: no such."""
    assert model.tables is not None
    shares = []
    for one in np.unique(robot):
        own = read[robot == one][alone[robot == one]]
        if len(own):
            middle = np.median(own)
            wide = max(NORMAL * np.median(np.abs(own - middle)), model.tables.ps_noise_floor)
            shares.append(float(np.mean(own > middle + FAR * wide)))
    return float(np.median(shares)) if shares else None


def _missed(
    read: FloatArray,
    alone: npt.NDArray[np.bool_],
    poses: FloatArray,
    robot: npt.NDArray[np.int64],
    model: PointModel,
) -> float | None:
    """Share of strong readings of the wall that are missing, of the middle robot; None: no such."""
    told = readings(poses, np.zeros(len(poses), dtype=np.int32), model=model).ps
    strong = alone & (told > STRONG)
    shares = [
        float(np.mean(read[mine][strong[mine]] < NONE))
        for mine in (robot == one for one in np.unique(robot))
        if strong[mine].any()
    ]
    return float(np.median(shares)) if shares else None


def _entries(seen: float | None, missed: float | None, *, gone: bool) -> Iterator[PreflightEntry]:
    """What the pre-flight says."""
    silenced = tuple(sorted(c.name for c in sense_causes().values() if c.columns[0] in (*PS, *LS)))
    told = {
        "strangers": (seen, "share of infrared that sees neither wall nor a logged robot"),
        "wall_missed": (missed, "share of infrared at the wall that does not see it"),
    }
    for name, (value, meaning) in told.items():
        entry = PreflightEntry(name=name, meaning=meaning, value=value, unit="1")
        if value is None:
            yield replace(entry, why="no infrared says so")
        elif gone:
            why = "infrared and light are not judged"
            yield replace(entry, follows="silences", why=why, causes=silenced)
        else:
            yield entry


def _there(columns: Collection[str]) -> Iterator[PreflightEntry]:
    """In place of what is said of a log without these columns: it has them all the same."""
    for kind, names in (("infrared", PS), ("light", LS)):
        if set(names) & set(columns):
            silenced = (c.name for c in sense_causes().values() if c.columns[0] in names)
            yield PreflightEntry(
                name=kind,
                meaning=f"whether the log has {kind}",
                value=True,
                follows="silences",
                why="not judged: somebody is not in the log, or the arena is another",
                causes=tuple(sorted(silenced)),
            )
