"""Every reader of what comes from outside, each with sound files that are then damaged."""

from __future__ import annotations

import gzip
import io
import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.models.belief.modelfile import ROBOTS, find_model_file, read_model_file
from realitygap.models.belief.tables import load_tables
from realitygap.models.log.measured import read_log
from realitygap.models.naming.health.reference import DIRECTORY, HOME, read_reference
from realitygap.models.naming.health.senses import read_sense_reference
from realitygap.reality.effects import parse_effects
from realitygap.studies.diagnosis.experiment import experiment
from realitygap.studies.fitness_gap.generations import coevolution_gap, read_generations
from realitygap.studies.gain.food import food_lines, read_transfer
from realitygap.studies.gain.held_out import _kind, hidden_in
from realitygap.studies.replay.watch import watch
from tests.fuzz.labs import LABS
from tests.fuzz.sound import DRIVE, ROWS, Reader, as_csv, as_parquet, table
from tests.models.small import arena_log


def generations() -> pd.DataFrame:
    """A small table of generations."""
    rng = np.random.default_rng(np.random.SeedSequence(1))
    rows = 12
    return pd.DataFrame(
        {
            "run": "run",
            "robot": np.arange(rows) % 3,
            "generation": np.arange(rows) // 3,
            "t_start": 60.0 * (np.arange(rows) // 3),
            "t_end": 60.0 * (np.arange(rows) // 3 + 1),
            "case": "light-at-nest",
            "s0_third": rng.integers(0, 3, rows),
            "fitness_sim": rng.uniform(0, 60, rows),
            "fitness_real": rng.uniform(0, 60, rows),
        }
    )


WRITERS: dict[str, Callable[[pd.DataFrame], bytes]] = {
    ".csv": as_csv,
    ".gz": lambda frame: gzip.compress(as_csv(frame), 1, mtime=0),
    ".parquet": as_parquet,
}
"""A table as a file, by the end of its name."""

EXTENSION = """
[lamps]
opposite = { x = -0.5, y = 0.0 }

[extension]
log = "00"
command = "realitygap diagnose a.csv"

[[extension.causes]]
name = "motor_saturation"
robots = [3, 1]
word = "left"

[extension.causes.parameters]
limit = { value = 4.5, low = 4.4, high = 4.6, unit = "rad/s" }

[[extension.causes]]
name = "lamp_intensity"
parameters = { scale = { value = 1.5 } }
"""


def _log(name: str) -> Reader:
    return Reader(
        lambda folder: read_log(
            folder if name == "samples.parquet" else folder / name, drive=DRIVE
        ),
        lambda: {name: WRITERS[Path(name).suffix](table())},
        (name,),
        name,
    )


def _model(folder: Path) -> object:
    read = read_model_file(folder / "model.toml")
    return read, read.point_model(), read.motion(3)


def _models() -> dict[str, bytes]:
    plain = (ROBOTS / "epuck.toml").read_text()
    plain = plain.split("[lamps]")[0] if "[lamps]" in plain else plain
    return {"model.toml": (plain + EXTENSION).encode()}


@cache
def _tables() -> dict[str, bytes]:
    source = find_model_file()
    model = read_model_file(source)
    assert model.sensors is not None
    return {"epuck.npz": (source.parent / model.sensors.tables).read_bytes()}


def _transfer() -> dict[str, bytes]:
    compared = {
        **{"metric": "food", "first": "extended", "second": "minimal", "verdict": "more"},
        **{"mean_first": 2.0, "mean_second": 1.0, "difference": 1.0, "low": 0.5, "high": 1.5},
    }
    one = {"label": "later", "comparisons": [compared]}
    content = {"schema": 1, "configuration": {"runs": 2}, "alterations": [one]}
    return {"transfer.json": json.dumps(content).encode()}


def _proposal() -> dict[str, bytes]:
    """A diagnosis that proposes a manoeuvre, with its model."""
    plan = {
        "step": 0.1,
        "ground": {"x": 0.0, "y": 0.0, "radius": 0.6, "walled": True},
        "rivals": [{"name": "motor_lag", "word": None, "values": {"time_constant": 0.1}}],
        "expected": [
            {
                **{"robot": 0, "t_start": 1.0, "t_end": 2.0, "channel": "along", "unit": "m"},
                **{"values": {"motor_lag": 0.1}, "apart": 3.0},
            }
        ],
    }
    following = {
        **{"name": "spins", "separates": ["motor_lag"], "does": "spins", "separation": 9.0},
        **{"lamp": "as it was", "needs": [], "menu": [], "commands": [], "plan": plan},
    }
    content = {"verdict": "ambiguous", "robots": [0, 1], "next_experiment": following}
    return {
        "diagnosis.json": json.dumps(content).encode(),
        "extended.toml": _models()["model.toml"],
        **_tables(),
    }


def _truth() -> dict[str, bytes]:
    hidden = parse_effects(("motor_lag:time_constant=0.1,robot=3", "lamp_intensity:scale=2"), 10)
    return {"truth.json": json.dumps({"effects": [one.truth() for one in hidden]}).encode()}


def _run() -> dict[str, bytes]:
    return {"run.json": b'{"config": {"controller": "search", "case": "no-light", "seed": 1}}'}


class Begun(Exception):
    """The command took its words and began to work."""


WORK = (
    "realitygap.studies.run.experiment.simulate",
    "realitygap.studies.run.capture.captured",
    "realitygap.studies.demo.chapters.tell",
    "realitygap.studies.diagnosis.diagnose.diagnose",
    "realitygap.studies.gain.measure.gain",
    "realitygap.studies.health.reference.measure_health",
    "realitygap.studies.paper.study.run_study",
    "realitygap.studies.blind.battery.run_battery",
    "realitygap.studies.transfer.study.run_transfer",
    "realitygap.studies.hidden.catalogue.document",
    "realitygap.studies.measure.ambiguous.processes",
    "realitygap.studies.measure.bench.point_model",
    "realitygap.studies.measure.convergence.convergence",
    "realitygap.studies.measure.gain_table.run_catalogue",
    "realitygap.studies.measure.healthy_scores.distances",
    "realitygap.studies.measure.inherent_gap.measure",
    "realitygap.studies.measure.scaling.measure",
    "realitygap.models.gap.whole.measure_gap",
)
"""What takes time, and begins only after all words were checked."""


def _words(words: Sequence[str]) -> object:
    """Everything of a command but its work."""
    import importlib

    import typer

    from realitygap.studies.cli import _UsageError, app

    patches = []
    for name in WORK:
        module, _, function = name.rpartition(".")
        patches.append(mock.patch.object(importlib.import_module(module), function, _begin))
        patches[-1].start()
    try:
        return app(list(words), standalone_mode=False)
    except (Begun, typer.Exit, typer.Abort):
        return None
    except _UsageError as error:
        raise InputError("words", error.format_message(), "other words") from None
    finally:
        for patch in patches:
            patch.stop()


def _begin(*_: object, **__: object) -> None:
    raise Begun


READERS: dict[str, Reader] = {
    "csv": _log("log.csv"),
    "packed csv": _log("log.csv.gz"),
    "parquet": _log("log.parquet"),
    "run directory": _log("samples.parquet"),
    "model": Reader(_model, _models, ("model.toml",)),
    "sensor tables": Reader(lambda f: load_tables(f / "epuck.npz"), _tables, ("epuck.npz",)),
    "reference": Reader(
        lambda f: read_reference(f / "r.json"),
        lambda: {"r.json": (DIRECTORY / HOME / "e-puck.json").read_bytes()},
        ("r.json",),
    ),
    "reference of the senses": Reader(
        lambda f: read_sense_reference(f / "r.json"),
        lambda: {"r.json": (DIRECTORY / HOME / "e-puck.senses.json").read_bytes()},
        ("r.json",),
    ),
    "generations": Reader(
        lambda f: coevolution_gap(read_generations(f / "generations.parquet")),
        lambda: {"generations.parquet": as_parquet(generations())},
        ("generations.parquet",),
        "generations.parquet",
    ),
    **LABS,
    "log to watch": Reader(
        lambda f: watch(f / "log.csv", f / "replay.html", force=True),
        lambda: {"log.csv": as_csv(table())},
        ("log.csv",),
        "log.csv",
    ),
    "diagnosis": Reader(experiment, _proposal, ("diagnosis.json", "extended.toml")),
    "truth": Reader(hidden_in, _truth, ("truth.json",)),
    "run.json": Reader(_kind, _run, ("run.json",)),
    "transfer": Reader(lambda f: food_lines(read_transfer(f)), _transfer, ("transfer.json",)),
    "SPEC": Reader(lambda text: parse_effects((text,), 10)),
    "command line": Reader(_words),
}


def table_of(reader: str) -> pd.DataFrame:
    """The sound table of a reader that has one."""
    if reader == "generations":
        return generations()
    if reader == "mapped csv":
        return pd.read_csv(io.BytesIO(LABS["mapped csv"].files()["lab.csv"]))
    return arena_log(1, robots=2, rows=ROWS).assign(nest=True) if reader == "parquet" else table()
