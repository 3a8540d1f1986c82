"""Is the physics converged? The same commands at finer steps and more solver iterations.

`realitygap measure convergence` drives twelve robots, far apart and without
walls, through the same 60 s of commands at twelve headings, then through five manoeuvres of a
figure each, and compares every setting of every engine with pybullet's finest one. Last it measures
what the engines do that no robot does (`studies.measure.artefacts`).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.reality import constants as k
from realitygap.reality.engine import Engine, EngineName
from realitygap.studies.measure.artefacts import Setting, artefacts

FloatArray = npt.NDArray[np.float64]

HEADINGS = 12
SECONDS = 60.0
SPACING = 5.0
"""m between robots that must not meet: one moves at most 7.6 m a minute, and mostly turns."""
SEED = 20_111


CHOSEN: dict[EngineName, Setting] = {
    "pybullet": Setting(k.PHYSICS_STEP, k.SOLVER_ITERATIONS, "pybullet"),
    "pybullet-strict": Setting(k.PHYSICS_STEP, k.STRICT_ITERATIONS, "pybullet-strict"),
    "mujoco": Setting(k.PHYSICS_STEP, k.NEWTON_ITERATIONS, "mujoco"),
}
"""Those in use."""
FINER: dict[EngineName, Setting] = {
    "pybullet": Setting(0.5 * k.PHYSICS_STEP, 10 * k.SOLVER_ITERATIONS, "pybullet"),
    "pybullet-strict": Setting(0.5 * k.PHYSICS_STEP, 10 * k.STRICT_ITERATIONS, "pybullet-strict"),
    "mujoco": Setting(0.5 * k.PHYSICS_STEP, k.NEWTON_ITERATIONS, "mujoco"),
}
FINEST = Setting(0.00125, 200, "pybullet")
WRONG: dict[EngineName, tuple[Setting, ...]] = {
    "pybullet": (
        Setting(k.PHYSICS_STEP, 4, "pybullet"),
        Setting(2.0 * k.PHYSICS_STEP, 5, "pybullet"),
    ),
    "pybullet-strict": (Setting(k.PHYSICS_STEP, 4, "pybullet-strict"),),
    "mujoco": (Setting(k.PHYSICS_STEP, 3, "mujoco"),),
}
"""Fast and wrong."""
SETTINGS = (
    CHOSEN["pybullet"],
    Setting(0.5 * k.PHYSICS_STEP, k.SOLVER_ITERATIONS, "pybullet"),
    Setting(k.PHYSICS_STEP, 10 * k.SOLVER_ITERATIONS, "pybullet"),
    FINER["pybullet"],
    FINEST,
    *WRONG["pybullet"],
    CHOSEN["pybullet-strict"],
    FINER["pybullet-strict"],
    *WRONG["pybullet-strict"],
    CHOSEN["mujoco"],
    FINER["mujoco"],
    Setting(FINEST.step, k.NEWTON_ITERATIONS, "mujoco"),
    Setting(2.0 * k.PHYSICS_STEP, k.NEWTON_ITERATIONS, "mujoco"),
    *WRONG["mujoco"],
)
ARTEFACTS = (
    CHOSEN["pybullet"],
    Setting(0.0025, k.SOLVER_ITERATIONS, "pybullet"),
    FINEST,
    CHOSEN["pybullet-strict"],
    Setting(0.0025, k.STRICT_ITERATIONS, "pybullet-strict"),
    CHOSEN["mujoco"],
    Setting(0.0025, k.NEWTON_ITERATIONS, "mujoco"),
)
"""Settings under which the engines' artefacts are measured."""

FULL = 6.0
"""rad/s."""
TOLERANCES = {
    "straight": 1.2e-3,
    "arc": 15e-3,
    "spin": 31e-3,
    "stop": 0.5e-3,
    "push": 6e-3,
}
"""m, rad: how far each manoeuvre's figure may be from the finest setting's. Our choice: half a per
cent of what lasts, what the tracker's noise is (0.5 mm) of a stop, a twentieth of a push, which is
rare."""


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
    engine = setting.engine()
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
    poses = np.zeros((robots, 3))
    engine.poses(poses)
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


def manoeuvres(setting: Setting) -> dict[str, float]:
    """One figure per manoeuvre of `TOLERANCES`, all after the start-up.

    straight: m driven in 2 s at full speed; arc: rad turned in 2 s at 2 and 6 rad/s; spin: rad
    turned in 2 s at -4 and 4 rad/s; stop: m rolled after full speed; push: m by which a robot whose
    motors hold with a fifth of their torque is pushed along in 2 s. Means over headings.
    """
    straight = drive([(10, FULL, FULL), (50, FULL, FULL)], setting)
    arc = drive([(10, 2.0, FULL), (50, 2.0, FULL)], setting)
    spin = drive([(10, -4.0, 4.0), (50, -4.0, 4.0)], setting)
    stop = drive([(25, FULL, FULL), (25, 0.0, 0.0)], setting)
    return {
        "straight": float((straight[:, -1, 0] - straight[:, 10, 0]).mean()),
        "arc": float((arc[:, -1, 2] - arc[:, 10, 2]).mean()),
        "spin": float((spin[:, -1, 2] - spin[:, 10, 2]).mean()),
        "stop": float((stop[:, -1, 0] - stop[:, 25, 0]).mean()),
        "push": _pushed(setting),
    }


def _pushed(setting: Setting) -> float:
    """m that a robot is pushed along by another within 2 s of contact; mean over headings."""
    engine = setting.engine()
    gap = 2.0 * k.BODY_RADIUS + 0.001
    try:
        for i in range(HEADINGS):
            yaw = 2.0 * np.pi * i / HEADINGS
            ahead = gap * np.array([np.cos(yaw), np.sin(yaw)])
            engine.add_epuck([SPACING * i, 0.0, yaw])
            engine.add_epuck([SPACING * i + ahead[0], ahead[1], yaw])
        for i in range(HEADINGS):
            engine.drive(2 * i, 0.5 * FULL, 0.5 * FULL, k.MOTOR_TORQUE)
            engine.drive(2 * i + 1, 0.0, 0.0, 0.2 * k.MOTOR_TORQUE)
        before = _poses(engine, 2 * HEADINGS)[1::2, :2]
        engine.advance(round(2.0 / setting.step))
        after = _poses(engine, 2 * HEADINGS)[1::2, :2]
    finally:
        engine.close()
    return float(np.hypot(*(after - before).T).mean())


def misses(setting: Setting, finest: dict[str, float]) -> dict[str, float]:
    """m, rad: how far each manoeuvre's figure is from the finest setting's."""
    found = manoeuvres(setting)
    return {name: found[name] - finest[name] for name in TOLERANCES}


def converged(off: dict[str, float]) -> bool:
    """Whether every manoeuvre is within its tolerance."""
    return all(abs(off[name]) <= tolerance for name, tolerance in TOLERANCES.items())


def minute() -> str:
    """The table of the 60 s drive, as Markdown."""
    commands = search_commands(SECONDS, np.random.default_rng(SEED))
    finest = drive(commands, FINEST)
    length = np.hypot(*np.diff(finest[0, :, :2], axis=0).T).sum()
    lines = [
        f"Path length {length:.2f} m in {SECONDS:.0f} s.\n",
        "| engine | step (ms) | iterations | after 60 s: position (mm) | heading (mrad) "
        "| per second: position (mm) | heading (mrad) | headings' spread per second (mm, mrad) |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for setting in SETTINGS:
        path = drive(commands, setting)
        end = path[:, -1] - finest[:, -1]
        position = float(np.sqrt((end[:, :2] ** 2).sum(axis=1).mean()))
        heading = float(np.sqrt((end[:, 2] ** 2).mean()))
        second = second_by_second(path, finest)
        spread = second_by_second(path, np.broadcast_to(path.mean(axis=0), path.shape))
        lines.append(
            f"{setting.cells} {1e3 * position:.1f} | {1e3 * heading:.1f} "
            f"| {1e3 * second[0]:.2f} | {1e3 * second[1]:.2f} "
            f"| {1e3 * spread[0]:.2f}, {1e3 * spread[1]:.2f} |"
        )
    return "\n".join(lines)


def figure_by_figure() -> str:
    """The table of the manoeuvres, as Markdown."""
    finest = manoeuvres(FINEST)
    units = {"straight": "mm", "arc": "mrad", "spin": "mrad", "stop": "mm", "push": "mm"}
    heads = [f"{name} ({1e3 * finest[name]:.1f} {units[name]})" for name in TOLERANCES]
    lines = [
        f"| engine | step (ms) | iterations | {' | '.join(heads)} | within tolerance |",
        "|---" * (4 + len(heads)) + "|",
        f"| | | tolerance | {' | '.join(f'{1e3 * most:g}' for most in TOLERANCES.values())} | |",
    ]
    for setting in SETTINGS:
        off = misses(setting, finest)
        cells = " | ".join(f"{1e3 * each:+.2f}" for each in off.values())
        lines.append(f"{setting.cells} {cells} | {'yes' if converged(off) else 'no'} |")
    return "\n".join(lines)


def convergence() -> str:
    """All tables, as Markdown."""
    last = artefacts(ARTEFACTS)
    return f"{minute()}\n\n{figure_by_figure()}\n\n{last}\n"
