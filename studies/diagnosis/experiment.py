"""The next experiment as something to run: commands for the robots, and what each rival expects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.probes import probe
from realitygap.models.belief.extended import NAME
from realitygap.models.log.files import checked
from realitygap.models.log.opened import json_values
from realitygap.models.naming.proposal.expected import Flown, flown
from realitygap.models.naming.proposal.ground import Ground
from realitygap.models.naming.proposal.menu import flight
from realitygap.studies.diagnosis.plan import ProposingTable, topics_of, write_twists
from realitygap.studies.diagnosis.result import FILE, DiagnosisResult
from realitygap.studies.inputs.model import Model
from realitygap.studies.pages.notebook import Telling, new_axes, rows_table
from realitygap.studies.plumbing.output import whole_directory, whole_file
from realitygap.studies.plumbing.provenance import file_read, versions, write_json

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FORMATS = {".csv": "table", ".parquet": "table", ".mcap": "ros2", "": "ros2"}
"""By ending of a file; a bag of ROS 2 is a directory, or one file of MCAP."""
EXPECTED = "the directory of a diagnosis, or its diagnosis.json"
BAG = "metadata.yaml"
"""What a bag's directory holds."""


@dataclass(frozen=True, eq=False, repr=False)
class ProposedExperiment(Telling):
    """A manoeuvre for these robots, and what is expected of it under each rival."""

    content: Mapping[str, Any]
    """Of the JSON file beside the commands (docs/files.md)."""
    commands: pd.DataFrame
    """Columns `t` (s), `robot`, `cmd_left`, `cmd_right` (rad/s, from `t` to the next row's); the
    last row of each robot stops it."""
    model: Model
    """Of the robots, with what else was named."""

    @property
    def expected(self) -> pd.DataFrame:
        """What tells the rivals apart, best first: a row per channel and cause.

        Columns `robot`, `t_start`, `t_end` (s), `channel`, `unit`, `cause`, `value`, `apart`
        (standard deviations of the log's noise between the named cause and its nearest rival).
        """
        rows = [
            {**{k: v for k, v in one.items() if k != "values"}, "cause": cause, "value": value}
            for one in self.content["expected"]
            for cause, value in one["values"].items()
        ]
        columns = ["robot", "t_start", "t_end", "channel", "unit", "cause", "value", "apart"]
        return rows_table(rows, columns, ("t_start", "t_end", "value", "apart"))

    def table_told(self) -> pd.DataFrame:
        """What tells the rivals apart."""
        return self.expected

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw both wheels' commands over time, a line per robot and wheel; returns the axes.

        Args:
            axes: To draw into; new ones if absent.
        """
        axes = new_axes(axes)
        for robot, own in self.commands.groupby("robot"):
            for side in ("left", "right"):
                axes.step(own["t"], own[f"cmd_{side}"], where="post", label=f"{robot}, {side}")
        axes.set_xlabel("time (s)")
        axes.set_ylabel("wheel speed (rad/s)")
        axes.legend(title="robot, wheel")
        return axes

    def write(self, out: Path | str, *, format: str | None = None, force: bool = False) -> None:
        """Write the commands, and beside them, ending in .json, what is expected.

        Args:
            out: .csv or .parquet (a table), .mcap or a directory (a bag of ROS 2).
            format: table or ros2; by the ending of `out` if absent.
            force: Replace what a former call has written.

        Raises:
            InputError: `out` has another ending, is there already or cannot be written, or a bag is
                asked for and the extra [ros] is not installed.
        """
        path = Path(out)
        _check_format(path, format)
        beside = path.with_suffix(".json")
        with whole_file(beside, force=force, ours=_is_ours) as told:
            if path.suffix:
                with whole_file(path, force=force) as part:
                    self._write(part)
            else:
                with whole_directory(path, force=force, holds=(BAG,)) as part:
                    self._write(part)
            write_json(told, dict(self.content))

    def _write(self, part: Path) -> None:
        """Into a file, or a directory that is there."""
        if part.suffix == ".csv":
            self.commands.to_csv(part, index=False)
        elif part.suffix == ".parquet":
            self.commands.to_parquet(part, index=False)
        else:
            write_twists(part, self.commands, self.model.file.nominal_drive)

    def told(self) -> tuple[str, str, str]:
        return f"Experiment: {self.content['manoeuvre']}", "\n".join(self.lines), ".commands"

    @property
    def lines(self) -> list[str]:
        """What to expect, in sentences."""
        return [_sentence(one) for one in self.content["expected"]]


def _check_format(out: Path, asked: str | None) -> None:
    """Refuse an ending that is none of the format asked for."""
    kinds = sorted(set(FORMATS.values()))
    if asked not in (None, *kinds):
        raise InputError("--format", repr(asked), f"{' or '.join(kinds)}")
    if out.suffix not in FORMATS or asked not in (None, FORMATS[out.suffix]):
        endings = [ending for ending, kind in FORMATS.items() if asked in (None, kind)]
        said = " or ".join(f"a file ending in {one}" if one else "a directory" for one in endings)
        raise InputError("--out", out.name, said)


def experiment(
    diagnosis: DiagnosisResult | Path | str,
    *,
    out: Path | str | None = None,
    format: str | None = None,
    force: bool = False,
) -> ProposedExperiment:
    """The manoeuvre that an ambiguous diagnosis proposes, as commands for its robots.

    Args:
        diagnosis: What `diagnose` returned, the directory it wrote, or its diagnosis.json.
        out: Where to write everything as well, as `write` does.
        format: Of `out`: table or ros2; by its ending if absent.
        force: Replace what a former call has written.

    Raises:
        InputError: the diagnosis cannot be used or proposes nothing, or `out` cannot be used.
    """
    content, model, inputs = _read(diagnosis)
    if content.get("next_experiment") is None:
        raise InputError(
            "DIAGNOSIS",
            f"the verdict {content.get('verdict')}, and no manoeuvre proposed",
            "an ambiguous one that proposes a manoeuvre; its not_checked says why there is none",
        )
    read = {name: content[name] for name in ProposingTable.model_fields if name in content}
    found = _planned(checked(ProposingTable, read, Path(FILE), "a diagnosis"), model)
    result = replace(found, content=dict(found.content) | inputs | {"versions": versions()})
    if out is not None:
        result.write(out, format=format, force=force)
    return result


def _read(given: DiagnosisResult | Path | str) -> tuple[Mapping[str, Any], Model, dict[str, Any]]:
    """A diagnosis, the model that it has extended, and which files these are."""
    if isinstance(given, DiagnosisResult):
        return given.content, given.extended, {"inputs": given.content["inputs"]}
    path = Path(given)
    path = path / FILE if path.is_dir() else path
    content = json_values(path, EXPECTED, field="DIAGNOSIS")
    if not isinstance(content, dict) or "verdict" not in content:
        raise InputError("DIAGNOSIS", path, EXPECTED)
    model = Model.load(path.parent / NAME)
    return content, model, {"inputs": [file_read("DIAGNOSIS", path), *model.entries()]}


def _planned(asked: ProposingTable, model: Model) -> ProposedExperiment:
    """The manoeuvre and its commands."""
    following, names, robot = asked.next_experiment, asked.robots, model.file.robot
    plan = following.plan
    place = Ground(
        **plan.ground.model_dump(),
        body_radius=robot.body_radius,
        fastest=robot.wheel_speed_max,
        step=plan.step,
    )
    point = replace(model.point(), drive=model.file.nominal_drive)
    planned = flown(flight(probe(following.name), len(names), point, place), place)
    told = following.model_dump(mode="json")
    return ProposedExperiment(
        content={
            "schema": 1,
            "manoeuvre": following.name,
            **{key: told[key] for key in ("does", "separates", "separation", "lamp", "needs")},
            "step": place.step,
            "seconds": place.step * len(planned.t),
            "ground": told["plan"]["ground"],
            "starts": [
                {"robot": name, **dict(zip(("x", "y", "yaw"), pose, strict=True))}
                for name, pose in zip(names, planned.poses[0].tolist(), strict=True)
            ],
            "topics": dict(zip(map(str, names), topics_of(names), strict=True)),
            "rivals": told["plan"]["rivals"],
            "expected": told["plan"]["expected"],
        },
        commands=_table(planned, names),
        model=model,
    )


def _table(planned: Flown, names: Sequence[int | str]) -> pd.DataFrame:
    """A row per moment and robot; at the end all stand."""
    t, commands = planned.t, planned.commands
    rows = np.vstack([commands, np.zeros((1, *commands.shape[1:]))])
    times = np.append(t, t[-1] + t[1])
    return pd.DataFrame(
        {
            "t": np.repeat(np.round(times, 9), len(names)),
            "robot": list(names) * len(times),
            "cmd_left": rows[..., 0].ravel(),
            "cmd_right": rows[..., 1].ravel(),
        }
    )


SHOWN = {"m": (1e3, "mm"), "rad": (180.0 / np.pi, "degrees"), "1": (1.0, "")}
"""Factor and unit in which a person is told a number."""


def _sentence(one: Mapping[str, Any]) -> str:
    """What one channel will show."""
    factor, unit = SHOWN.get(one["unit"], (1.0, one["unit"]))
    values = ", ".join(f"{cause} {factor * value:.3g}" for cause, value in one["values"].items())
    told = f"{one['channel']} ({unit})" if unit else one["channel"]
    if one["robot"] is None:
        return f"{told}: {values}"
    when = f"{one['t_start']:.2f} s"
    if one["t_end"] > one["t_start"]:
        when = f"{one['t_start']:.2f} to {one['t_end']:.2f} s"
    return f"robot {one['robot']}, {when}, {told}: {values}"


def _is_ours(path: Path) -> bool:
    """Whether a file is one that `write` has written beside commands."""
    content = json_values(path, "a JSON file")
    return isinstance(content, dict) and "manoeuvre" in content
