"""Real robots' logs: what is named, and how well later runs are predicted beside rivals.

Every data set is cut in two by time. From the earlier runs come a diagnosis, its extended model
and all rivals; the later runs judge them. Rivals are what a laboratory would do otherwise: least
squares on wheels and axle (as UMBmark corrects them), all terms of the point model free at once,
and trees that learn the minimal model's error from the commands: they are no model of a robot, but
say how much could be predicted at all.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import replay_believed
from realitygap.models.gap.conditions import conditions
from realitygap.models.gap.replay import HORIZONS, errors, windows
from realitygap.models.log.formats.optiodom import read_optiodom
from realitygap.models.log.frames import Windows
from realitygap.models.log.measured import MeasuredLog, read_table
from realitygap.models.naming.claims.ahead import Ahead
from realitygap.models.naming.claims.calibration import GEOMETRY, MOTORS, Paths, terms_of
from realitygap.studies.diagnosis.diagnose import diagnose
from realitygap.studies.diagnosis.result import DiagnosisResult
from realitygap.studies.inputs.logs import as_log
from realitygap.studies.inputs.model import Model

VARIABLE = "REALITYGAP_DATA"
"""Of the environment: the folder that holds `optiodom/` and `drive/`."""
SECONDS = ("1 s", "5 s", "20 s")
MOST_WINDOWS = 6000
"""Windows of each horizon that the trees learn from, and that all are judged on: it bounds work."""
RESAMPLED = 400
"""Bootstrap samples of runs."""
RIVALS = {"wheels and axle": terms_of(GEOMETRY), "all terms": terms_of((*MOTORS, *GEOMETRY))}
BINS, BEFORE, BIN = 4, 4, 0.25
"""Parts of a window, and parts of so many seconds before it, whose commands the trees are given."""


@dataclass(frozen=True, kw_only=True)
class DataSet:
    """One robot on one floor."""

    name: str
    model: str
    """Of a shipped model file; of a table of `drive/` the first word of its name."""
    frame: pd.DataFrame


def data_sets(folder: Path) -> Iterator[DataSet]:
    """The data sets of a folder, in the order of their names.

    Raises:
        InputError: there is none, or what rivals need is not installed.
    """
    if find_spec("sklearn") is None:
        expected = "the extra [compare] to be installed: pip install 'reality-gap[compare]'"
        raise InputError("scikit-learn", "not installed", expected)
    found = False
    for session in sorted(folder.glob("optiodom/*/*")):
        if session.is_dir():
            found = True
            frame = read_optiodom(session, drive=Model.load("optiodom").file.motion().drive)
            yield DataSet(
                name=f"optiodom-{session.parent.name}-{session.name}", model="optiodom", frame=frame
            )
    for table in sorted(folder.glob("drive/*.parquet")):
        found = True
        model = table.stem.partition("-")[0]
        yield DataSet(name=table.stem, model=model, frame=read_table(table))
    if not found:
        raise InputError(VARIABLE, str(folder), "a folder with optiodom/ or drive/*.parquet")


def data_folder(given: Path | None) -> Path:
    """The folder asked for, or that of the environment.

    Raises:
        InputError: neither is given, or it is no folder.
    """
    said = str(given) if given is not None else os.environ.get(VARIABLE)
    if said is None:
        raise InputError(VARIABLE, "nothing", "a folder of measured logs")
    if not Path(said).is_dir():
        raise InputError(VARIABLE, said, "a folder of measured logs")
    return Path(said)


def in_time(frame: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The earlier and the later half: of the runs in their order, or of a single one's time."""
    if "run" not in frame or frame["run"].nunique() < 2:
        middle = 0.5 * (frame["t"].min() + frame["t"].max())
        early = frame["t"] < middle
    else:
        runs = list(dict.fromkeys(frame["run"]))
        early = frame["run"].isin(runs[: (len(runs) + 1) // 2])
    return frame[early].reset_index(drop=True), frame[~early].reset_index(drop=True)


def measured(data: DataSet) -> tuple[pd.DataFrame, DiagnosisResult]:
    """How far every model is off on the later half, and what the diagnosis of the earlier says.

    Returns:
        A row per model and horizon: `position` (m) and `heading` (rad), mean absolute errors, and
        `windows`; of the extended model also `low` and `high`, 95 % of how much smaller than the
        minimal model's its position error is (m), by resampling runs. And the diagnosis.
    """
    early, late = in_time(data.frame)
    model = Model.load(data.model)
    log, later = (as_log(frame, model) for frame in (early, late))
    said = diagnose(log, model=model)
    minimal, extended = model.file, said.extended.file
    robots = sorted({int(r) for r in later.measured.segments["robot"]})
    free = _fitted(log.measured, minimal, robots)
    motions: dict[str, dict[int, Motion]] = {
        "minimal": {r: minimal.motion(r) for r in robots},
        "extended": {r: extended.motion(r) for r in robots},
        **{name: {r: one[r] for r in robots} for name, one in free.items()},
    }
    tables = [_judged(name, later.measured, own) for name, own in motions.items()]
    tables.append(_trees(log.measured, later.measured, motions["minimal"]))
    every = pd.concat(tables, ignore_index=True)
    return _summary(every), said


def _fitted(log: MeasuredLog, file: ModelFile, robots: list[int]) -> dict[str, dict[int, Motion]]:
    """Rivals' motions by name and robot."""
    ahead = Ahead(log, conditions(log, file))
    found: dict[str, dict[int, Motion]] = {}
    for name, terms in RIVALS.items():
        for robot in robots:
            paths = Paths(ahead, robot, file.motion(robot), None, terms)
            at = paths.run()
            motion = file.motion(robot) if at is None else paths.motion(at)
            found.setdefault(name, {})[robot] = motion
    return found


def _windows(log: MeasuredLog, horizon: str) -> Windows:
    pairs = windows(log, HORIZONS[horizon])
    every = max(1, len(pairs.first) // MOST_WINDOWS)
    return Windows(pairs.first[::every], pairs.last[::every])


def _rows(
    name: str, log: MeasuredLog, errors_of: Callable[[str, Windows], FloatArray | None]
) -> pd.DataFrame:
    """(windows,) errors of one model at every horizon."""
    parts = []
    for horizon in SECONDS:
        pairs = _windows(log, horizon)
        error = errors_of(horizon, pairs) if len(pairs.first) else None
        if error is not None:
            parts.append(
                pd.DataFrame(
                    {
                        "model": name,
                        "horizon": horizon,
                        "segment": log.segment[pairs.first],
                        "window": np.arange(len(pairs.first)),
                        "position": np.hypot(error[:, 0], error[:, 1]),
                        "heading": np.abs(error[:, 2]),
                    }
                )
            )
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


def _judged(name: str, log: MeasuredLog, believed: Mapping[int, Motion]) -> pd.DataFrame:
    path, seen = replay_believed(log, believed), log.poses
    return _rows(name, log, lambda horizon, pairs: errors(seen, path, pairs))


def _trees(log: MeasuredLog, later: MeasuredLog, minimal: Mapping[int, Motion]) -> pd.DataFrame:
    """The minimal model with its error as trees learn it from the commands."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    paths = {id(one): replay_believed(one, minimal) for one in (log, later)}

    def off(horizon: str, pairs: Windows) -> FloatArray | None:
        known = _windows(log, horizon)
        if len(known.first) < 2 * BINS:
            return None
        given, wanted = _commands(log, known), errors(log.poses, paths[id(log)], known)
        left = errors(later.poses, paths[id(later)], pairs)
        asked = _commands(later, pairs)
        for k in range(3):
            tree = HistGradientBoostingRegressor(random_state=0).fit(given, wanted[:, k])
            left[:, k] -= tree.predict(asked)
        return left

    return _rows("trees", later, off)


def _commands(log: MeasuredLog, pairs: Windows) -> FloatArray:
    """(windows, features) mean commands (rad/s) before and within windows."""
    segment = log.segment[pairs.first]
    first = log.t[log.start[:-1]][segment]
    begin, long = log.t[pairs.first], log.t[pairs.last] - log.t[pairs.first]
    edges = [begin - BIN * k for k in range(BEFORE, 0, -1)]
    edges += [begin + long * k / BINS for k in range(BINS + 1)]
    columns = []
    turned = np.vstack(
        [np.zeros(2), np.cumsum(log.commands[:-1] * np.diff(log.t)[:, None], axis=0)]
    )
    far = 2.0 * (float(np.ptp(log.t)) + BIN * BEFORE + 1.0)
    axis = log.t + far * log.segment
    for a, b in itertools.pairwise(edges):
        low = np.maximum(a, first) + far * segment
        high = np.maximum(b, first) + far * segment
        for side in (0, 1):
            moved = np.interp(high, axis, turned[:, side]) - np.interp(low, axis, turned[:, side])
            columns.append(moved / np.maximum(b - a, 1e-9))
    return np.column_stack(columns)


def _summary(every: pd.DataFrame) -> pd.DataFrame:
    """Means, and how sure the extended model's gain is."""
    rows = []
    rng = np.random.default_rng(np.random.SeedSequence(0))
    for (horizon, model), one in every.groupby(["horizon", "model"], sort=False):
        row = {
            "horizon": horizon,
            "model": model,
            "position": float(one["position"].mean()),
            "heading": float(one["heading"].mean()),
            "windows": len(one),
            "low": np.nan,
            "high": np.nan,
        }
        if model == "extended":
            base = every[(every["horizon"] == horizon) & (every["model"] == "minimal")]
            won = base["position"].to_numpy() - one["position"].to_numpy()
            row["low"], row["high"] = _sure(won, one["segment"].to_numpy(), rng)
        rows.append(row)
    return pd.DataFrame(rows)


def _sure(won: FloatArray, run: Any, rng: np.random.Generator) -> tuple[float, float]:
    """95 % interval of a mean, by resampling runs, or tenths of a single one."""
    each = np.unique(run, return_inverse=True)[1]
    if each.max() == 0:
        each = np.arange(len(won)) * 10 // len(won)
    total, number = np.bincount(each, won), np.bincount(each)
    picks = rng.integers(0, len(total), (RESAMPLED, len(total)))
    tried = total[picks].sum(axis=1) / np.maximum(number[picks].sum(axis=1), 1)
    low, high = np.quantile(tried, (0.025, 0.975))
    return float(low), float(high)
