"""A robot of nobody's catalogue, in numpy alone: none of the program's code moves it.

    python -m tests.own_robot docs/example

writes the example's logs: two stretches of one afternoon, as a tracker would export them.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd

RADIUS, AXLE = 0.036, 0.23
"""m, by its data sheet."""
LARGER = 1.02
"""What its data sheet does not say: the right wheel's radius over the left one's."""
LAG = 0.06
"""s, time constant of its motors."""
NOISE = np.array([1e-3, 1e-3, 5e-3])
"""m, m, rad: standard deviations of its tracker."""
FINE = 5e-3
"""s in which the heading is taken for its mean; wheels speed up exactly."""


def own_log(
    seconds: float, *, rate: float = 20.0, seed: int = 0, larger: float = LARGER, lag: float = LAG
) -> pd.DataFrame:
    """A log with commands of the body: `t`, `x`, `y`, `yaw`, `cmd_v`, `cmd_omega`; SI units."""
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    every, rows = round(1.0 / (rate * FINE)), round(seconds * rate)
    told = np.zeros((rows, 2))
    begin = 0
    while begin < rows:
        lasts = round(rng.uniform(0.8, 3.0) * rate)
        spins = rng.random() < 0.15
        told[begin : begin + lasts] = (
            (0.0, rng.choice([-1.2, 1.2]))
            if spins
            else (rng.uniform(0.08, 0.25), rng.normal(0, 0.5))
        )
        begin += lasts
    told = told.round(4)
    wheels = (told[:, :1] + told[:, 1:] * [[-AXLE / 2, AXLE / 2]]) / RADIUS
    poses, pose, speed = np.zeros((rows, 3)), np.array([0.4, -0.2, 0.3]), np.zeros(2)
    radius = RADIUS * 2.0 * np.array([1.0, larger]) / (1.0 + larger)
    left_over = np.exp(-FINE / lag) if lag else 0.0
    for k in range(rows):
        poses[k] = pose
        for _ in range(every):
            short = (speed - wheels[k]) * (1.0 - left_over) * lag
            left, right = radius * (FINE * wheels[k] + short)
            speed = wheels[k] + (speed - wheels[k]) * left_over
            turn, way = (right - left) / AXLE, (left + right) / 2.0
            middle = pose[2] + turn / 2.0
            pose += way * np.cos(middle), way * np.sin(middle), turn
    poses += NOISE * rng.standard_normal(poses.shape)
    return pd.DataFrame(
        {
            "t": np.arange(rows) / rate,
            "x": poses[:, 0],
            "y": poses[:, 1],
            "yaw": poses[:, 2],
            "cmd_v": told[:, 0],
            "cmd_omega": told[:, 1],
        }
    )


def example() -> dict[str, pd.DataFrame]:
    """The example's logs by name, in its tracker's columns and units."""
    log = own_log(100.0)
    heading = np.degrees((log["yaw"] + np.pi) % (2.0 * np.pi) - np.pi)
    table = pd.DataFrame(
        {
            "stamp_ms": (1e3 * log["t"]).round().astype(int),
            "pos_x_mm": (1e3 * log["x"]).round(2),
            "pos_y_mm": (1e3 * log["y"]).round(2),
            "heading_deg": heading.round(3),
            "v": log["cmd_v"],
            "w": log["cmd_omega"],
        }
    )
    early = table["stamp_ms"] < 60_000
    return {"log.csv": table[early], "later.csv": table[~early]}


if __name__ == "__main__":
    for name, table in example().items():
        table.to_csv(Path(sys.argv[1]) / name, index=False)
