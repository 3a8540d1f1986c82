"""Is the physics converged? The same 60 s of commands at finer steps and more solver iterations.

`python -m studies.convergence [OUT.md]` drives twelve robots, far apart and without walls, through
the same commands at twelve headings, and compares every setting with the finest one.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from reality import constants as k
from reality._optics import lib
from reality.engine import Engine
from reality.senses import doubles

FloatArray = npt.NDArray[np.float64]

HEADINGS = 12
SECONDS = 60.0
SPACING = 5.0
"""m between robots that must not meet: one moves at most 7.6 m a minute, and mostly turns."""
SEED = 20_111


@dataclass(frozen=True)
class Setting:
    """Physics step (s) and solver iterations."""

    step: float
    iterations: int


CHOSEN = Setting(k.PHYSICS_STEP, k.SOLVER_ITERATIONS)
FINEST = Setting(0.00125, 200)
SETTINGS = (
    CHOSEN,
    Setting(0.010, 200),
    Setting(0.005, 20),
    Setting(0.005, 200),
    Setting(0.0025, 200),
    FINEST,
)


def search_commands(seconds: float, random: np.random.Generator) -> list[tuple[int, float, float]]:
    """(control steps, left, right) as a robot at large commands them: curves, spins, full stops."""
    left = round(seconds / k.CONTROL_STEP)
    commands: list[tuple[int, float, float]] = []
    while left > 0:
        steps = min(left, int(random.integers(10, 50)))
        inner = 6.0 * (1.0 - 0.8 * random.random())
        turns = ((inner, 6.0), (6.0, inner), (-4.0, 4.0), (4.0, -4.0), (0.0, 0.0), (6.0, 6.0))
        commands.append((steps, *turns[random.integers(len(turns))]))
        left -= steps
    return commands


def drive(
    commands: list[tuple[int, float, float]], setting: Setting, headings: int = HEADINGS
) -> FloatArray:
    """Paths (headings, control steps + 1, 3): x, y, unwrapped yaw in each robot's first frame."""
    engine = Engine(step=setting.step, iterations=setting.iterations)
    try:
        yaw = 2.0 * np.pi * np.arange(headings) / headings
        for i in range(headings):
            engine.add_epuck([SPACING * i, 0.0, yaw[i]])
        path = [_poses(engine, headings)]
        for steps, left, right in commands:
            for i in range(headings):
                engine.drive(i, left, right, k.MOTOR_TORQUE)
            for _ in range(steps):
                engine.advance(round(k.CONTROL_STEP / setting.step))
                path.append(_poses(engine, headings))
    finally:
        engine.close()
    poses = np.array(path).transpose(1, 0, 2)
    poses[:, :, 2] = np.unwrap(poses[:, :, 2], axis=1)
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    offset = poses[:, :, :2] - poses[:, :1, :2]
    return np.stack(
        [
            c * offset[:, :, 0] + s * offset[:, :, 1],
            c * offset[:, :, 1] - s * offset[:, :, 0],
            poses[:, :, 2] - poses[:, :1, 2],
        ],
        axis=2,
    )


def _poses(engine: Engine, robots: int) -> FloatArray:
    raw, poses = np.zeros((robots, 7)), np.zeros((robots, 3))
    engine.centres_of_mass(raw)
    lib.rgo_poses(robots, doubles(raw), doubles(np.array(k.CENTRE_OF_MASS)), doubles(poses))
    return poses


def second_by_second(path: FloatArray, other: FloatArray) -> tuple[float, float]:
    """r.m.s. disagreement of the motion over 1 s: m and rad, each from the same start."""
    stride = round(1.0 / k.CONTROL_STEP)

    def motion(p: FloatArray) -> FloatArray:
        start, end = p[:, :-1:stride][:, : (p.shape[1] - 1) // stride], p[:, stride::stride]
        c, s = np.cos(start[..., 2]), np.sin(start[..., 2])
        dx, dy = end[..., 0] - start[..., 0], end[..., 1] - start[..., 1]
        return np.stack([c * dx + s * dy, c * dy - s * dx, end[..., 2] - start[..., 2]], axis=-1)

    apart = motion(path) - motion(other)
    return (
        float(np.sqrt((apart[..., 0] ** 2 + apart[..., 1] ** 2).mean())),
        float(np.sqrt((apart[..., 2] ** 2).mean())),
    )


def study() -> str:
    """The table, as Markdown."""
    commands = search_commands(SECONDS, np.random.default_rng(SEED))
    finest = drive(commands, FINEST)
    length = np.hypot(*np.diff(finest[0, :, :2], axis=0).T).sum()
    lines = [
        "| step (ms) | iterations | after 60 s: position (mm) | heading (rad) "
        "| per second: position (mm) | heading (mrad) | headings' spread per second (mm, mrad) |",
        "|---|---|---|---|---|---|---|",
    ]
    for setting in SETTINGS:
        path = drive(commands, setting)
        end = path[:, -1] - finest[:, -1]
        position = float(np.sqrt((end[:, :2] ** 2).sum(axis=1).mean()))
        heading = float(np.sqrt((end[:, 2] ** 2).mean()))
        second = second_by_second(path, finest)
        spread = second_by_second(path, np.broadcast_to(path.mean(axis=0), path.shape))
        lines.append(
            f"| {1e3 * setting.step:g} | {setting.iterations} "
            f"| {1e3 * position:.1f} | {heading:.4f} "
            f"| {1e3 * second[0]:.2f} | {1e3 * second[1]:.2f} "
            f"| {1e3 * spread[0]:.2f}, {1e3 * spread[1]:.2f} |"
        )
    return f"Path length {length:.2f} m in {SECONDS:.0f} s.\n\n" + "\n".join(lines) + "\n"


if __name__ == "__main__":
    table = study()
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(table, encoding="utf-8")
    else:
        sys.stdout.write(table)
