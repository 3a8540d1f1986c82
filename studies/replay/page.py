"""One page that plays a log: nothing is fetched, and nothing of a log is read as a program."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from realitygap.studies.inputs.logs import Log
from realitygap.studies.replay.packed import LIGHT_STEPS, RAY_STEPS, TURN_BITS, packed
from realitygap.studies.replay.scene import Scene
from realitygap.studies.replay.sight import reach


def write_player(
    path: Path,
    log: Log,
    scenes: Sequence[Scene],
    restart: float,
    title: str,
    hidden: Sequence[tuple[float, float]] = (),
) -> None:
    """Write the page.

    Args:
        path: The file.
        log: Whose model is drawn.
        scenes: Of the log.
        restart: s after which the ghosts begin anew.
        title: Of the page.
        hidden: Places (m) of lamps that the model does not know.
    """
    environment = Environment(
        loader=PackageLoader("realitygap.studies.replay", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    page = environment.get_template("replay.html.j2").render(
        title=title,
        lead=f"{log.size}; ghosts follow the model {log.model.name}.",
        notes=log.notes,
        about=_about(log, scenes, restart) | {"hidden": list(hidden)},
    )
    path.write_text(page, encoding="utf-8")


def _about(log: Log, scenes: Sequence[Scene], restart: float) -> dict[str, Any]:
    """What the page's script reads."""
    point, arena = log.model.point(), log.model.file.arena
    return {
        "body": point.body_radius,
        "wall": None if arena is None else point.arena_radius,
        "nest": None if arena is None else list(point.nest),
        "lamps": [None if lamp is None else list(lamp) for lamp in point.lamps],
        "angles": list(point.sensor_angles),
        "reach": reach(point),
        "captured": point.tables is not None,
        "raySteps": RAY_STEPS,
        "lightSteps": LIGHT_STEPS,
        "turn": 2.0 * np.pi / 2**TURN_BITS,
        "restart": restart,
        "runs": [packed(scene, point.body_radius, reach(point)) for scene in scenes],
    }
