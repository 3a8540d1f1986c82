"""A log as a film, for slides and documents: what the page shows, without its controls."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Circle

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.studies.inputs.logs import Log
from realitygap.studies.replay.scene import Scene

RATE = 10
"""Pictures a second; our choice: smooth enough for robots."""
LONGEST = 20.0
"""s of a film; a longer run plays faster. Our choice: 200 pictures, some megabytes."""
INCHES, DOTS = 5.0, 96
GHOST, FOOD, RAY, NEST, LAMP = "#c2185b", "#2f8f5b", "#d1495b", "#2f8f5b", "#e0a100"
THIRDS = ("#6f9bd8", "#a3a3a3", "#ef9a5c")
"""Of what a robot believes of the lamp, as on the page."""
UNKNOWN = "#b9c2cc"


def check_film() -> None:
    """Refuse where ffmpeg is not installed.

    Raises:
        InputError: it is not.
    """
    if shutil.which("ffmpeg") is None:
        expected = "the program ffmpeg to be installed, or a file ending in .gif"
        raise InputError("--out", "mp4", expected)


def write_film(path: Path, log: Log, scene: Scene) -> None:
    """Write a film, .gif or .mp4 by the path's ending.

    Args:
        path: The file.
        log: Whose model is drawn.
        scene: One run.
    """
    speed = max(1.0, float(scene.times[-1]) / LONGEST)
    wanted = np.arange(0.0, scene.times[-1] + 1e-9, speed / RATE)
    frames = np.minimum(np.round(wanted / scene.step), len(scene.times) - 1).astype(int)
    figure, axes = plt.subplots(figsize=(INCHES, INCHES))
    figure.subplots_adjust(left=0.14, right=0.98, bottom=0.1, top=0.94)
    try:
        stage = _Stage(axes, log.model.point(), log.model.file.arena is not None, scene, speed)
        writer = PillowWriter(fps=RATE) if path.suffix == ".gif" else FFMpegWriter(fps=RATE)
        with writer.saving(figure, str(path), dpi=DOTS):
            for frame in frames.tolist():
                stage.show(frame)
                writer.grab_frame()
    finally:
        plt.close(figure)


class _Stage:
    """The picture, of which every frame changes some parts."""

    def __init__(
        self, axes: Any, point: PointModel, walled: bool, scene: Scene, speed: float
    ) -> None:
        self._axes, self._point, self._scene = axes, point, scene
        self._faster = "" if speed == 1.0 else f" (× {speed:.3g})"
        self._moving: list[Any] = []
        if walled:
            axes.add_patch(Circle((0, 0), point.arena_radius, fill=False, linewidth=2))
            axes.add_patch(Circle(point.nest[:2], point.nest[2], color=NEST, alpha=0.2))
        low, high = self._extent(walled)
        middle, half = 0.5 * (low + high), 0.5 * float((high - low).max()) + point.body_radius
        axes.set(
            aspect="equal",
            xlim=(middle[0] - half, middle[0] + half),
            ylim=(middle[1] - half, middle[1] + half),
            xlabel="x (m)",
            ylabel="y (m)",
        )

    def _extent(self, walled: bool) -> tuple[FloatArray, FloatArray]:
        """(2,) m each: the lower left and the upper right corner."""
        if walled:
            reach = np.full(2, 1.05 * self._point.arena_radius)
            return -reach, reach
        places = self._scene.poses[..., :2].reshape(-1, 2)
        return np.nanmin(places, axis=0), np.nanmax(places, axis=0)

    def show(self, frame: int) -> None:
        """Draw one frame."""
        for part in self._moving:
            part.remove()
        scene, axes, body = self._scene, self._axes, self._point.body_radius
        poses, ghosts = scene.poses[:, frame], scene.ghosts[:, frame]
        seen, ghostly = (np.isfinite(one[:, 0]) for one in (poses, ghosts))
        colours = [self._colour(robot, frame) for robot in np.flatnonzero(seen).tolist()]
        bodies = [Circle(one[:2], body) for one in poses[seen]]
        dashed = [Circle(one[:2], body) for one in ghosts[ghostly]]
        self._moving = [
            axes.add_collection(
                PatchCollection(dashed, facecolor="none", edgecolor=GHOST, linestyle="--")
            ),
            axes.add_collection(PatchCollection(bodies, facecolor=colours, edgecolor="#333333")),
            axes.add_collection(LineCollection(_headings(poses[seen], body), colors="#333333")),
        ]
        if scene.rays is not None:
            lines = self._lines(poses, scene.rays[:, frame])
            self._moving.append(axes.add_collection(LineCollection(lines, colors=RAY)))
        if scene.carries is not None:
            food = [Circle(one[:2], 0.35 * body) for one in poses[seen & scene.carries[:, frame]]]
            self._moving.append(
                axes.add_collection(PatchCollection(food, facecolor=FOOD, zorder=3))
            )
        lamp = self._point.lamps[scene.lamp[frame]] if scene.lamp[frame] >= 0 else None
        if lamp is not None:
            self._moving += axes.plot(*lamp, marker="*", markersize=18, color=LAMP)
        axes.set_title(f"{scene.times[frame]:.0f} s{self._faster}")

    def _colour(self, robot: int, frame: int) -> str:
        """By what the robot believes."""
        now = self._scene.begin + self._scene.times[frame]
        for one in self._scene.beliefs.get(self._scene.robots[robot], ()):
            if one.begin <= now < one.end:
                return THIRDS[one.third]
        return UNKNOWN

    def _lines(self, poses: FloatArray, rays: FloatArray) -> list[FloatArray]:
        """(2, 2) m each, from the body to what a sensor seems to see."""
        body = self._point.body_radius
        found = []
        for k, angle in enumerate(self._point.sensor_angles):
            there = np.isfinite(rays[:, k]) & np.isfinite(poses[:, 0])
            yaw = poses[there, 2] + angle
            way = np.column_stack([np.cos(yaw), np.sin(yaw)])
            near = poses[there, :2] + body * way
            found += list(np.stack([near, near + rays[there, k, None] * way], axis=1))
        return found


def _headings(poses: FloatArray, body: float) -> list[FloatArray]:
    """(2, 2) m each, from the middle to the rim."""
    ahead = body * np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
    return list(np.stack([poses[:, :2], poses[:, :2] + ahead], axis=1))
