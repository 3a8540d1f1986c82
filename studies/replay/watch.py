"""Watch: a log as something that plays, in a page, a film or Rerun.

The page fetches nothing, and nothing of a log is read as a program.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from realitygap.embedded_sim.errors import InputError
from realitygap.models.log.opened import opened
from realitygap.studies.inputs.logs import AnyLog, Log, as_log
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.progress import unseen
from realitygap.studies.replay.film import check_film, write_film
from realitygap.studies.replay.packed import LIGHT_STEPS, RAY_STEPS, TURN_BITS, packed
from realitygap.studies.replay.recording import check_rerun, write_recording
from realitygap.studies.replay.scene import Scene, scenes
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


FORMATS = {"html": ".html", "rerun": ".rrd", "mp4": ".mp4", "gif": ".gif"}
"""Ending of a file by format."""
RESTART = 5.0
"""s after which a ghost begins anew; our choice: a healthy e-puck is then off by millimetres."""
LONGEST_RESTART = 3600.0
"""s; our choice: beyond an hour a ghost tells nothing."""


def watch(
    log: AnyLog,
    out: Path | str,
    *,
    format: str | None = None,
    model: AnyModel = None,
    restart: float = RESTART,
    hidden: Sequence[tuple[float, float]] = (),
    title: str | None = None,
    force: bool = False,
    begin: Callable[[str], None] = unseen,
) -> dict[str, Any]:
    """Make something to watch of a log: robots, what they sense and believe, and their ghosts.

    A ghost is where the model says that a robot is, from the measured pose some seconds ago on.

    Args:
        log: A measured log or several, as `read_log` takes them; of a run's directory also what
            its robots believed.
        out: The file: .html (a page that plays), .rrd (Rerun), .mp4 or .gif (a film of the first
            run).
        format: html, rerun, mp4 or gif; by the ending of `out` if absent.
        model: What the ghosts follow; that of the log, or the e-puck, if absent.
        restart: s after which a ghost begins anew at the measured pose.
        hidden: Places (m) of lamps that the model does not know; a page draws them dashed.
        title: Of the page; names the log if absent.
        force: Replace a file that is there.
        begin: Called with the name of each stage.

    Returns:
        `replay` (path), `format`, `bytes`, `robots`, `step` (s between frames), `restart` (s),
        `runs` (`run`, `seconds`, `frames`, `robots`), `notes` on the log's repairs.

    Raises:
        InputError: the log or the model cannot be used, `out` cannot, or its format needs a
            library that is not installed.
        Diverged: the replay left the finite numbers.
    """
    path, kind = Path(out), _format(Path(out), format)
    if not 0.0 < restart <= LONGEST_RESTART:
        expected = f"seconds, above 0 and at most {LONGEST_RESTART:g}"
        raise InputError("--restart", f"{restart:g}", expected)
    {"rerun": check_rerun, "mp4": check_film}.get(kind, lambda: None)()
    with whole_file(path, force=force, ours=_ours(kind)) as part:
        if not (isinstance(log, Log) and model is None):
            model = Model.load(model)  # refused before the log is read
        begin("reading the log")
        read = as_log(log, model)
        begin("replaying it")
        seen = scenes(read, restart)
        begin(f"writing {path.name}")
        named = title or f"Replay of {', '.join(one.name for one in read.sources)}"
        if kind == "html":
            write_player(part, read, seen, restart, named, hidden)
        elif kind == "rerun":
            write_recording(part, read, seen)
        else:
            write_film(part, read, seen[0])
        size = part.stat().st_size
    return {
        "replay": str(path),
        "format": kind,
        "bytes": size,
        "robots": list(read.robots),
        "step": seen[0].step,
        "restart": restart,
        "runs": [
            {
                "run": one.run,
                "seconds": float(one.times[-1]),
                "frames": len(one.times),
                "robots": list(one.robots),
            }
            for one in seen
        ],
        "notes": list(read.notes),
    }


def _format(out: Path, asked: str | None) -> str:
    """The format, which the file's ending must agree with."""
    if asked is not None and asked not in FORMATS:
        raise InputError("--format", repr(asked), f"one of {', '.join(FORMATS)}")
    kinds = [kind for kind, ending in FORMATS.items() if ending == out.suffix]
    if not kinds or (asked or kinds[0]) != kinds[0]:
        ending = " or ".join(FORMATS.values()) if asked is None else FORMATS[asked]
        raise InputError("--out", out.name, f"a file ending in {ending}")
    return kinds[0]


MOST_BYTES = 2**36
"""bytes of a file that is looked at before it is replaced; no replay is larger."""
BEGINS = {
    "html": b"<!doctype html>",
    "rerun": b"RR",
    "mp4": b"",
    "gif": b"GIF8",
}
"""First bytes of a file by format; of mp4 they follow a length."""


def _ours(kind: str) -> Callable[[Path], bool]:
    """Whether a file that may be replaced is of the format that is written."""

    def ours(path: Path) -> bool:
        with opened(path, "a replay", most=MOST_BYTES) as file:
            head = file.read(16)
        return head[4:8] == b"ftyp" if kind == "mp4" else head.startswith(BEGINS[kind])

    return ours
