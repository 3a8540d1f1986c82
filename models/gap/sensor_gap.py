"""The readings the point model gets wrong: residuals of every sensor, and what they depend on."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.conditions import Bins, bins, edges_bins
from realitygap.models.gap.flips import Means, residual_maps, scores
from realitygap.models.gap.motion_gap import blocks, condition_bins
from realitygap.models.gap.sensing import (
    SPACING,
    Predicted,
    averaged_poses,
    judged_rows,
    measured,
    predict,
    rows_around,
    scenarios,
)
from realitygap.models.gap.shares import Share, split
from realitygap.models.gap.stood import poses_as_stood
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise
from realitygap.models.log.schema import LS, PS

KINDS = {"ps": slice(0, SENSORS), "ls": slice(SENSORS, 2 * SENSORS)}
WALL_EDGES = (-np.inf, 0.01, 0.02, 0.04, 0.07, np.inf)
"""m between body and wall: infrared falls by half every centimetre or so."""
NAMES = (*PS, *LS)


class SensorGap(NamedTuple):
    """One kind of sensor of a log."""

    kind: str
    channels: tuple[str, ...]
    residual: FloatArray
    """(rows, channels) counts, measured minus predicted."""
    predicted: FloatArray
    """(rows, channels) counts."""
    table: pd.DataFrame
    """(rows,) conditions."""
    clear: npt.NDArray[np.bool_]
    """(rows,) no other robot in infrared range."""
    shares: dict[str, Share]
    """By channel; of infrared, over the rows at which any sensor should see the wall."""
    maps: list[Means]


def sensor_gap(
    log: MeasuredLog,
    model: PointModel,
    replayed: FloatArray,
    noise: PoseNoise,
    table: pd.DataFrame,
    seed: np.random.SeedSequence,
    *,
    family: int,
    own: Mapping[int, PointModel] = MappingProxyType({}),
    seen: Mapping[int, tuple[Motion, Motion]] = MappingProxyType({}),
) -> list[SensorGap]:
    """Infrared and light, where the log has them and the model can predict them.

    Args: as `motion_gap`; `family`, how many families of maps are judged together; `own`, models of
        single robots; `seen`, as `senses.sight.look`, robots whose markers are believed off.
    """
    kinds = sensors_to_judge(log, model)
    if not kinds or model.tables is None:
        return []
    rows = judged_rows(log)
    if not len(rows):
        return []
    poses, count = averaged_poses(log, replayed, rows, rows_around(log, replayed, noise))
    poses = poses_as_stood(log, model, rows, poses, seen)
    predicted = predict(log, model, poses, count, rows, noise, own)
    there = table.iloc[rows].reset_index(drop=True)
    there = there.assign(**_place(poses, model, scenarios(log)[rows]))
    free = there["near_robot"].to_numpy() > model.tables.ps_range
    read = measured(log, rows)
    generators = [np.random.default_rng(child) for child in seed.spawn(len(kinds))]
    return [
        _kind(log, kind, rows, read, predicted, there, free, rng, family, model)
        for kind, rng in zip(kinds, generators, strict=True)
    ]


def sensors_to_judge(log: MeasuredLog, model: PointModel) -> list[str]:
    """The kinds of sensor that the log holds and the model can predict."""
    if model.tables is None:
        return []
    kinds = ["ps"] if any(name in log.frame for name in PS) else []
    if any(name in log.frame for name in LS) and (scenarios(log) >= 0).any():
        kinds.append("ls")
    return kinds


def _kind(
    log: MeasuredLog,
    kind: str,
    rows: npt.NDArray[np.int64],
    read: FloatArray,
    predicted: Predicted,
    table: pd.DataFrame,
    free: npt.NDArray[np.bool_],
    rng: np.random.Generator,
    family: int,
    model: PointModel,
) -> SensorGap:
    """Residuals, shares and maps of one kind of sensor."""
    columns = KINDS[kind]
    present = [k for k in range(*columns.indices(2 * SENSORS)) if NAMES[k] in log.frame]
    channels = tuple(NAMES[k] for k in present)
    residual = (read - predicted.mean)[:, present]
    floor = predicted.noise[:, present]
    found = scores(residual, floor, blocks(log, rows, SPACING))
    cuts = {n: c for n, c in condition_bins(log, table).items() if n not in ("near_wall",)}
    cuts |= _sensor_bins(table, model)
    kept = {
        name: cut if name == "near_robot" else cut._replace(group=np.where(free, cut.group, -1))
        for name, cut in cuts.items()
    }
    maps = residual_maps(found, kept, channels, rng, family=family)
    seen = free & (predicted.mean[:, present] > 0).any(axis=1) if kind == "ps" else free
    seen = seen if seen.any() else free
    shares = {c: split(residual[seen, k], floor[seen, k]) for k, c in enumerate(channels)}
    return SensorGap(
        kind, channels, residual, predicted.mean[:, present], table, free, shares, maps
    )


def _place(
    poses: FloatArray, model: PointModel, scenario: npt.NDArray[np.int32]
) -> dict[str, FloatArray]:
    """Conditions that matter to sensors: distance and bearing of wall and lamp."""
    x, y, yaw = poses.T
    radius = np.hypot(x, y)
    lamps = np.array([lamp or (np.nan, np.nan) for lamp in model.lamps])
    lamp = np.where((scenario >= 0)[:, None], lamps[scenario], np.nan)
    dx, dy = lamp[:, 0] - x, lamp[:, 1] - y
    return {
        "radius": radius,
        "heading": np.mod(yaw, 2 * np.pi),
        "sector": np.mod(np.arctan2(y, x), 2 * np.pi),
        "wall_distance": model.arena_radius - model.body_radius - radius,
        "wall_bearing": np.mod(np.arctan2(y, x) - yaw, 2 * np.pi),
        "lamp_distance": np.hypot(dx, dy),
        "lamp_bearing": np.mod(np.arctan2(dy, dx) - yaw, 2 * np.pi),
    }


def _sensor_bins(table: pd.DataFrame, model: PointModel) -> dict[str, Bins]:
    """Groups of the conditions that only sensors have."""
    assert model.tables is not None
    wall = table["wall_distance"].to_numpy()
    bearing = bins("heading", table["wall_bearing"].to_numpy())
    seen = wall < model.tables.ps_range
    sight = (-np.inf, model.tables.ps_range, np.inf)
    return {
        "wall_distance": edges_bins(wall, WALL_EDGES, "m"),
        "wall_bearing": bearing._replace(group=np.where(seen, bearing.group, -1)),
        "near_robot": edges_bins(table["near_robot"].to_numpy(), sight, "m"),
        "lamp_distance": bins("lamp_distance", table["lamp_distance"].to_numpy()),
        "lamp_bearing": bins("heading", table["lamp_bearing"].to_numpy()),
    }
