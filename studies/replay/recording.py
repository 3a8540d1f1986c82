"""A log as a recording of Rerun (.rrd), beside whatever else a lab has logged with it."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import wrapped
from realitygap.studies.inputs.logs import Log
from realitygap.studies.replay.scene import Scene

NAME = "realitygap"
GHOST, BODY, WALL, NEST = (194, 24, 91), (120, 144, 168), (90, 90, 90), (47, 143, 91)
CORNERS = 96
"""Of a circle; our choice: round to the eye."""


def check_rerun() -> None:
    """Refuse where the library is not installed.

    Raises:
        InputError: it is not.
    """
    if find_spec("rerun") is None:
        expected = "the extra [rerun] to be installed: pip install 'reality-gap[rerun]'"
        raise InputError("--format", "rerun", expected)


def write_recording(path: Path, log: Log, scenes: Sequence[Scene]) -> None:
    """Write the recording.

    By run and robot the body, its heading, its ghost and the distance between them on a timeline
    `t` (s, that of the log). Rerun's vertical axis points down, so that y is turned over.

    Args:
        path: The file.
        log: Whose model is drawn.
        scenes: Of the log.
    """
    import rerun as rr

    recording = rr.RecordingStream(NAME, recording_id=NAME, send_properties=False)
    recording.save(path)
    point = log.model.point()
    if log.model.file.arena is not None:
        rings = [_circle(0.0, 0.0, point.arena_radius), _circle(*point.nest)]
        arena = rr.LineStrips2D(rings, colors=[WALL, NEST])
        recording.log("arena", arena, static=True)
    for scene in scenes:
        for robot, name in enumerate(scene.robots):
            # a name from outside is one part of a path, whatever is in it
            place = rr.escape_entity_path_part(scene.run), rr.escape_entity_path_part(name)
            _send(rr, recording, "/".join(place), scene, robot, point.body_radius)
    recording.disconnect()


def _send(rr: Any, recording: Any, place: str, scene: Scene, robot: int, body: float) -> None:
    """One robot of one run."""
    poses, ghosts = scene.poses[robot], scene.ghosts[robot]
    seen, both = (np.isfinite(one[:, 0]) for one in (poses, poses + ghosts))
    for name, path, there, colour in (
        ("robot", poses, seen, BODY),
        ("ghost", ghosts, np.isfinite(ghosts[:, 0]), GHOST),
    ):
        at, number = path[there], int(there.sum())
        if not number:
            continue
        when = [rr.TimeColumn("t", duration=scene.begin + scene.times[there])]
        columns = rr.Points2D.columns(
            positions=_down(at[:, :2]), radii=[body] * number, colors=[colour] * number
        )
        recording.send_columns(f"{place}/{name}", when, columns)
        ahead = 1.6 * body * np.column_stack([np.cos(at[:, 2]), np.sin(at[:, 2])])
        arrows = rr.Arrows2D.columns(origins=_down(at[:, :2]), vectors=_down(ahead))
        recording.send_columns(f"{place}/{name}/heading", when, arrows)
    if both.any():
        off = poses[both] - ghosts[both]
        when = [rr.TimeColumn("t", duration=scene.begin + scene.times[both])]
        far = np.hypot(off[:, 0], off[:, 1])
        for name, values in (("off_m", far), ("off_rad", np.abs(wrapped(off[:, 2])))):
            scalars = rr.Scalars.columns(scalars=values)
            recording.send_columns(f"{place}/{name}", when, scalars)


def _down(vectors: FloatArray) -> FloatArray:
    """(n, 2) with y turned over."""
    return vectors * [1.0, -1.0]


def _circle(x: float, y: float, radius: float) -> FloatArray:
    """(corners, 2) m."""
    angle = np.linspace(0.0, 2 * np.pi, CORNERS)
    return _down(np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)]))
