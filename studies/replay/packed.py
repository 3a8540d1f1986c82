"""A scene as few bytes that a page can hold: whole numbers, differences, deflated, as text.

What the page's script unpacks is documented here and nowhere else. In this order, robot after robot
and frame after frame, each number less the one before it of the same robot:

- 16 bits each, all low bytes before all high ones: x, y, yaw, and the ghost's x, y, yaw;
- 8 bits each: flags (1 seen, 2 ghost, 4 carries food), then rays (8 sensors), then light (8
  sensors), these two only where the log has them;
- 8 bits per frame: the lamp's place and 1.

Positions are counted in `unit` from `origin`, angles in 2 pi / 2^TURN_BITS. A ray is 0 for nothing,
else 1 and its length in `RAY_STEPS` parts of the reach. What is not known repeats what was before.
"""

from __future__ import annotations

import base64
import math
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS
from realitygap.embedded_sim.model import FloatArray
from realitygap.studies.replay.scene import Scene

TURN_BITS = 12
"""Of a whole turn: steps of 1.5 mrad, a tenth of a screen's pixel on a body's rim; our choice."""
FINE = 0.01
"""Of the body's radius, least unit of length; our choice: a third of a pixel."""
SPAN = 60_000
"""Units that a run's places may extend over: 16 bits, less what ghosts stray."""
RAY_STEPS = 63
LIGHT_STEPS = 15
"""Steps of rays and light; our choice: what an eye can tell."""


def packed(scene: Scene, body_radius: float, reach: float) -> dict[str, Any]:
    """Of JSON: what a page needs of a scene; `body_radius` and the `reach` of its infrared in m."""
    places = np.concatenate([scene.poses[..., :2], scene.ghosts[..., :2]], axis=1)
    known = places[np.isfinite(places).all(axis=-1)]
    low, high = (known.min(axis=0), known.max(axis=0)) if len(known) else (np.zeros(2),) * 2
    origin, unit = 0.5 * (low + high), max(float((high - low).max()) / SPAN, FINE * body_radius)
    content = b"".join(_parts(scene, origin, unit, reach))
    return {
        "run": scene.run,
        "begin": scene.begin,
        "step": scene.step,
        "frames": scene.poses.shape[1],
        "robots": list(scene.robots),
        "origin": origin.tolist(),
        "unit": unit,
        "low": low.tolist(),
        "high": high.tolist(),
        "rays": scene.rays is not None,
        "light": scene.light is not None,
        "carries": scene.carries is not None,
        "beliefs": [
            [
                [one.begin, one.end, one.third, one.s0 if math.isfinite(one.s0) else None]
                for one in scene.beliefs.get(robot, ())
            ]
            for robot in scene.robots
        ],
        "data": base64.b64encode(zlib.compress(content, 9)).decode("ascii"),
    }


def _parts(scene: Scene, origin: FloatArray, unit: float, reach: float) -> list[bytes]:
    """The scene's numbers in the order above."""
    zero, units = np.append(origin, 0.0), np.array([unit, unit, 2 * np.pi / 2**TURN_BITS])
    parts = []
    for poses in (scene.poses, scene.ghosts):
        counted = _kept((poses - zero) / units)
        parts += [_words(counted[..., k]) for k in range(3)]
    flags = 1 * np.isfinite(scene.poses[..., 0]) + 2 * np.isfinite(scene.ghosts[..., 0])
    if scene.carries is not None:
        flags = flags + 4 * scene.carries
    parts.append(_bytes(flags))
    if scene.rays is not None:
        length = 1.0 + RAY_STEPS * scene.rays / reach
        parts += [_bytes(np.nan_to_num(length[..., k])) for k in range(SENSORS)]
    if scene.light is not None:
        parts += [_bytes(LIGHT_STEPS * scene.light[..., k]) for k in range(SENSORS)]
    return [*parts, _bytes(scene.lamp[None] + 1)]


def _kept(numbers: FloatArray) -> FloatArray:
    """(robots, frames, n) numbers; where one is not known the last that was, or 0."""
    known = np.isfinite(numbers).all(axis=-1)
    last = np.maximum.accumulate(np.where(known, np.arange(known.shape[1]), 0), axis=1)
    return np.nan_to_num(np.take_along_axis(numbers, last[..., None], axis=1))


def _words(numbers: FloatArray) -> bytes:
    """(robots, frames) as differences of 16 bits, low bytes first."""
    whole = np.round(numbers).astype(np.int64)
    change = np.diff(whole, axis=1, prepend=0).astype(np.uint16)
    return (change & 255).astype(np.uint8).tobytes() + (change >> 8).astype(np.uint8).tobytes()


def _bytes(numbers: npt.NDArray[Any]) -> bytes:
    """(robots, frames) as differences of 8 bits."""
    whole = np.round(numbers).astype(np.int64)
    return np.diff(whole, axis=1, prepend=0).astype(np.uint8).tobytes()
