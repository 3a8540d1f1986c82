"""The embedded simulator's entries into C: evaluate genomes, replay commands, predict readings.

Python crosses into C once per batch. Arrays are C-contiguous float64 unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import numpy.typing as npt

from embedded_sim._core import ffi, lib
from embedded_sim.behaviour import Behaviour
from embedded_sim.errors import Diverged
from embedded_sim.model import CONTROL_STEP, SENSORS, Drive, FloatArray, PointModel

TRIAL_SECONDS = 60.0
"""s a genome forages virtually (paper, III-E); T_max of eq. 1."""


Form = Literal["best", "one_by_one", "avx2", "avx512"]
"""How trials are computed: the best way there is, one by one, or up to 32 side by side in SIMD
lanes of an instruction set."""
FORMS: tuple[Form, ...] = get_args(Form)


def has_form(form: Form) -> bool:
    """Whether this processor, and this build, can compute that way."""
    return bool(lib.rg_has_form(FORMS.index(form)))


class Evaluation(NamedTuple):
    """Result of foraging trials."""

    fitness: FloatArray
    """(trials,) s, eq. 1."""
    deposits: npt.NDArray[np.int32]
    """(trials,) items brought to the nest."""


def evaluate(
    genomes: npt.ArrayLike,
    scenarios: npt.ArrayLike,
    seeds: npt.ArrayLike,
    *,
    model: PointModel,
    behaviour: Behaviour | Sequence[Behaviour],
    seconds: float = TRIAL_SECONDS,
    form: Form = "best",
) -> Evaluation:
    """Forage once per trial, one simulated robot alone in the arena (paper, III-E).

    Args:
        genomes: (trials, 2), G0 and G1 in [0, 0.99].
        scenarios: (trials,) index into `SCENARIOS`.
        seeds: (trials, 4) uint32, the trial's random stream.
        model: What the simulator believes.
        behaviour: The controller's constants, of all trials or (trials,).
        seconds: Length of a trial, T_max of eq. 1.
        form: How it is computed; the bits are the same.

    Raises:
        ValueError: shapes disagree, a scenario is not 0, 1 or 2, or the model cannot be run.
        Diverged: a trial left the finite numbers.
    """
    genes = np.ascontiguousarray(genomes, dtype=np.float64)
    if genes.ndim != 2 or genes.shape[1] != 2:
        raise ValueError(f"genomes: got shape {genes.shape}, expected (trials, 2)")
    trials = len(genes)
    scenario = _exact(scenarios, np.int32, (trials,), "scenarios")
    if trials and not 0 <= scenario.min() <= scenario.max() <= 2:
        raise ValueError(f"scenarios: got {scenario.min()}..{scenario.max()}, expected 0, 1 or 2")
    seed = _exact(seeds, np.uint32, (trials, 4), "seeds")
    result = Evaluation(np.empty(trials), np.empty(trials, dtype=np.int32))
    trial_set = ffi.new("rg_trials *")
    trial_set.steps, trial_set.trials = round(seconds / CONTROL_STEP), trials
    trial_set.form = FORMS.index(form)
    trial_set.genomes = _pointer("double[]", genes)
    trial_set.scenarios = _pointer("int32_t[]", scenario)
    trial_set.seeds = _pointer("uint32_t[]", seed)
    trial_set.fitness = _pointer("double[]", result.fitness)
    trial_set.deposits = _pointer("int32_t[]", result.deposits)
    shared = behaviour if isinstance(behaviour, Behaviour) else Behaviour()
    if not isinstance(behaviour, Behaviour):
        if len(behaviour) != trials:
            raise ValueError(f"behaviour: got {len(behaviour)}, expected one or {trials}")
        own = ffi.new("rg_behaviour[]", [each.struct[0] for each in behaviour])
        trial_set.behaviours = own
    at = ffi.new("int32_t[2]")
    status = lib.rg_evaluate(model.struct, shared.struct, trial_set, at)
    if status == lib.RG_BAD_ARGUMENT and not has_form(form):
        raise ValueError(f"form: got {form}, expected a form that this processor has")
    if status == lib.RG_BAD_ARGUMENT:
        most = (lib.RG_COMMAND_SLOTS - 2) * CONTROL_STEP
        raise ValueError(
            f"model: got {model.food_items} food items, a nest of {model.nest[2]} m and "
            f"{model.drive.latency} s of latency, expected at most {lib.RG_FOOD_MAX} items, a nest "
            f"that leaves room for them, and at most {most:g} s"
        )
    if status == lib.RG_NOT_FINITE:
        genome = genes[at[0]].tolist()
        raise Diverged(f"the point model diverged in trial {at[0]}, step {at[1]} (genome {genome})")
    return result


class Replay(NamedTuple):
    """Dead reckoning of logged commands."""

    poses: FloatArray
    """(rows, 3): x, y, yaw (m, m, rad; yaw not wrapped) at each row's time."""
    speeds: FloatArray
    """(rows, 2): wheel speeds (rad/s) at each row's time."""


def replay(
    t: npt.ArrayLike,
    commands: npt.ArrayLike,
    start: npt.ArrayLike,
    initial: npt.ArrayLike,
    *,
    drive: Drive,
) -> Replay:
    """Drive logged commands through the point model, all runs and robots in one call.

    The command chain is integrated once; the motion over any window is the difference of two poses.

    Args:
        t: (rows,) s, increasing within a segment.
        commands: (rows, 2) rad/s left and right, valid from their row's time to the next.
        start: (segments + 1,) first row of each segment (one run of one robot), and the row count.
        initial: (segments, 3) pose at each segment's first row.
        drive: The motion model.

    Raises:
        ValueError: shapes disagree.
        Diverged: a pose left the finite numbers; says which row.
    """
    times = np.ascontiguousarray(t, dtype=np.float64)
    rows = len(times)
    command = _exact(commands, np.float64, (rows, 2), "commands")
    starts = np.ascontiguousarray(start, dtype=np.int64)
    segments = len(starts) - 1
    if segments < 0 or starts[0] != 0 or starts[-1] != rows or np.any(np.diff(starts) < 1):
        raise ValueError(f"start: got {starts}, expected increasing rows from 0 to {rows}")
    first = _exact(initial, np.float64, (segments, 3), "initial")
    result = Replay(np.empty((rows, 3)), np.empty((rows, 2)))
    at = ffi.new("int64_t *")
    status = lib.rg_replay(
        drive.struct(),
        segments,
        _pointer("int64_t[]", starts),
        _pointer("double[]", times),
        _pointer("double[]", command),
        _pointer("double[]", first),
        _pointer("double[]", result.poses),
        _pointer("double[]", result.speeds),
        at,
    )
    if status == lib.RG_NOT_FINITE:
        raise Diverged(f"the replay diverged at row {at[0]} (t = {times[at[0]]} s)")
    return result


class Readings(NamedTuple):
    """What the point model's sensors read, without noise."""

    ps: FloatArray
    """(rows, 8) counts."""
    ls: FloatArray
    """(rows, 8) counts."""


def readings(
    poses: npt.ArrayLike,
    scenarios: npt.ArrayLike,
    t: npt.ArrayLike | None = None,
    *,
    model: PointModel,
) -> Readings:
    """Predict the sensors at given poses, (rows, 3), under each row's lamp scenario, (rows,).

    `t`, (rows,) s since the log began, matters to a lamp that decays; None: all at its beginning.

    Raises:
        ValueError: shapes disagree, or the model has no sensor tables.
        Diverged: a pose is not finite; says which row.
    """
    pose = np.ascontiguousarray(poses, dtype=np.float64)
    if pose.ndim != 2 or pose.shape[1] != 3:
        raise ValueError(f"poses: got shape {pose.shape}, expected (rows, 3)")
    rows = len(pose)
    scenario = _exact(scenarios, np.int32, (rows,), "scenarios")
    if rows and not 0 <= scenario.min() <= scenario.max() <= 2:
        raise ValueError(f"scenarios: got {scenario.min()}..{scenario.max()}, expected 0, 1 or 2")
    times = np.zeros(rows) if t is None else _exact(t, np.float64, (rows,), "t")
    result = Readings(np.empty((rows, SENSORS)), np.empty((rows, SENSORS)))
    at = ffi.new("int64_t *")
    status = lib.rg_readings(
        model.struct,
        rows,
        _pointer("double[]", pose),
        _pointer("int32_t[]", scenario),
        _pointer("double[]", times),
        _pointer("double[]", result.ps),
        _pointer("double[]", result.ls),
        at,
    )
    if status == lib.RG_NOT_FINITE:
        raise Diverged(f"a pose is not finite at row {at[0]}")
    return result


def _exact(
    values: npt.ArrayLike, dtype: npt.DTypeLike, shape: tuple[int, ...], name: str
) -> npt.NDArray[Any]:
    """The values as a contiguous array of one type and shape, or a ValueError naming them."""
    array = np.ascontiguousarray(values, dtype=dtype)
    if array.shape != shape:
        raise ValueError(f"{name}: got shape {array.shape}, expected {shape}")
    return array


def _pointer(kind: str, array: npt.NDArray[Any]) -> Any:
    """The array's memory as a C pointer; the caller keeps the array alive."""
    return ffi.from_buffer(kind, array)
