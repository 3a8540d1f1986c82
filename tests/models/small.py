"""Small logs and tables, made by hand, for the tests of `models`."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, PointModel, Tables, readings, replay
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.formats.tabular import Asked, read_csv_log

ROOT = Path(__file__).parents[2]


def shared_data(name: str) -> Path:
    """A folder of real measured logs; the test is skipped where it is absent."""
    said = os.environ.get("REALITYGAP_DATA")
    folder = Path(said or ROOT.parent / "shared" / "data") / name
    if not folder.is_dir():
        state = f"REALITYGAP_DATA is {said}" if said else "REALITYGAP_DATA is not set"
        pytest.skip(f"needs the measured data {name}: no folder {folder} ({state})")
    return folder


def tables() -> Tables:
    """Sensors that follow simple laws, on coarse axes."""
    u = np.linspace(0, 1, 9)
    distance, cosine = 0.1 * u**2, np.linspace(0, 1, 5)
    ps = 2000 * np.exp(-distance / 0.02)[None, :, None] * cosine[None, None, :] * np.ones((8, 1, 1))
    bearing = -np.pi + 2 * np.pi * np.arange(24) / 24
    ls = 1500 * np.exp(-1.3 * u**2)[:, None] * np.maximum(np.cos(bearing), 0)[None, :]
    return Tables(
        ps_counts=ps.astype(np.float32),
        ps_range=0.1,
        ps_noise=np.full(8, 0.1),
        ps_noise_floor=5.0,
        ls_counts=ls.astype(np.float32),
        ls_range=1.3,
        ls_dark=4095.0,
        ls_noise=10.0,
    )


def random_commands(rng: np.random.Generator, rows: int, hold: int = 20) -> FloatArray:
    """(rows, 2) rad/s, a new pair every `hold` rows, between -2 and 6."""
    pairs = rng.uniform(-2, 6, (rows // hold + 1, 2))
    return np.ascontiguousarray(np.repeat(pairs, hold, axis=0)[:rows])


def driven_log(
    seed: int = 0,
    *,
    robots: int = 2,
    rows: int = 500,
    step: float = 0.04,
    drive: Drive | None = None,
    position_noise: float = 0.0,
    heading_noise: float = 0.0,
    t: FloatArray | None = None,
) -> pd.DataFrame:
    """A log made by the point model itself in the open, with white tracker noise."""
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    times = np.arange(rows) * step if t is None else t
    parts = []
    for robot in range(robots):
        commands = random_commands(rng, rows)
        start = rng.uniform(-1, 1, (1, 3))
        poses = replay(times, commands, [0, rows], start, drive=drive or Drive()).poses
        noise = rng.normal(0, 1, (rows, 3)) * [position_noise, position_noise, heading_noise]
        x, y, yaw = (poses + noise).T
        columns = {"run": "a", "robot": robot, "t": times, "x": x, "y": y, "yaw": yaw}
        left, right = commands.T
        parts.append(pd.DataFrame({**columns, "cmd_left": left, "cmd_right": right}))
    return pd.concat(parts, ignore_index=True)


def arena_log(
    seed: int = 0,
    *,
    robots: int = 3,
    rows: int = 1500,
    drive: Drive | None = None,
    sensors: Tables | None = None,
    position_noise: float = 0.0005,
    heading_noise: float = 0.005,
    case: str = "light-at-nest",
) -> pd.DataFrame:
    """A log made by the point model itself, robots staying within the e-puck's arena, with sensors.

    `drive` is the drive the robots really have; all else is nominal.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 1]))
    model = PointModel(tables=sensors or tables(), drive=drive or Drive())
    t, hold = np.arange(rows) * 0.04, 20
    parts = []
    for robot in range(robots):
        pose, commands, poses = rng.uniform([-0.3, -0.3, -3], [0.3, 0.3, 3]), [], []
        for first in range(0, rows, hold):
            n = min(hold + 1, rows - first)
            ahead, wander = [], rng.uniform(-2, 6, 2)
            for pair in (wander, np.array([4.0, -4.0]) * rng.choice([-1, 1])):
                held = np.tile(pair, (n, 1))
                ahead = replay(t[:n], held, [0, n], pose[None], drive=model.drive).poses
                if np.hypot(*ahead[:, :2].T).max() < 0.56:
                    break
            poses.append(ahead[:hold])
            commands.append(held[:hold])
            pose = ahead[-1]
        true, command = np.vstack(poses)[:rows], np.vstack(commands)[:rows]
        read = readings(true, np.full(rows, {"light-at-nest": 2}.get(case, 1)), model=model)
        noise = rng.uniform(-1, 1, (rows, 16))
        ps = (
            read.ps + (model.tables.ps_noise * read.ps + model.tables.ps_noise_floor) * noise[:, :8]
        )
        ls = read.ls + model.tables.ls_noise * noise[:, 8:]
        sensed = np.clip(np.hstack([ps, ls]), 0, 4095)
        spread = [position_noise, position_noise, heading_noise]
        x, y, yaw = (true + rng.normal(0, 1, (rows, 3)) * spread).T
        parts.append(
            pd.DataFrame(
                {"run": "a", "robot": robot, "t": t, "x": x, "y": y, "yaw": yaw}
                | {"cmd_left": command[:, 0], "cmd_right": command[:, 1]}
                | {f"ps{k}": sensed[:, k] for k in range(8)}
                | {f"ls{k}": sensed[:, 8 + k] for k in range(8)}
                | {"case": case}
            )
        )
    return pd.concat(parts, ignore_index=True)


def read_mapped(path: Path, map_path: Path, *, drive: Drive | None = None) -> pd.DataFrame:
    """A file as a measured-log table by a map's file."""
    return read_csv_log(path, Asked(drive=drive or Drive(), map=map_path)).table
