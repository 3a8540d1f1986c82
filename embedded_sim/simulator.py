"""The embedded simulator's entries into C: evaluate genomes, replay commands, predict readings.

Python crosses into C once per batch. Arrays are C-contiguous float64 unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, get_args

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim._core import ffi, lib
from realitygap.embedded_sim.behaviour import Behaviour
from realitygap.embedded_sim.binding import array, check, finite, memory, refusal
from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.model import CONTROL_STEP, SENSORS, Drive, FloatArray, PointModel

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
        InputError: shapes disagree, a number is out of range, the model leaves no room for food, or
            this processor has not that form.
        Diverged: a trial left the finite numbers.
    """
    genes = array("genomes", genomes, np.float64, (None, 2))
    trials = len(genes)
    scenario = array("scenarios", scenarios, np.int32, (trials,))
    seed = array("seeds", seeds, np.uint32, (trials, 4))
    (length,) = finite("seconds", (seconds,), 1)
    longest = lib.RG_STEPS_MAX * CONTROL_STEP
    if not 0.0 <= length <= longest:
        raise InputError("seconds", f"{length:g}", f"from 0 to {longest:g} s")
    if form not in FORMS or not has_form(form):
        raise InputError("form", form, "a form that this processor has")
    result = Evaluation(np.empty(trials), np.empty(trials, dtype=np.int32))
    trial_set = ffi.new("rg_trials *")
    trial_set.steps, trial_set.trials = round(length / CONTROL_STEP), trials
    trial_set.form = FORMS.index(form)
    trial_set.genomes = memory("double[]", genes)
    trial_set.scenarios = memory("int32_t[]", scenario)
    trial_set.seeds = memory("uint32_t[]", seed)
    trial_set.fitness = memory("double[]", result.fitness)
    trial_set.deposits = memory("int32_t[]", result.deposits)
    shared = behaviour if isinstance(behaviour, Behaviour) else Behaviour()
    if not isinstance(behaviour, Behaviour):
        if len(behaviour) != trials:
            raise InputError("behaviour", f"{len(behaviour)}", f"one or {trials}")
        own = ffi.new("rg_behaviour[]", [each.struct[0] for each in behaviour])
        trial_set.behaviours = own
    why = refusal()
    check(lib.rg_evaluate(model.struct, shared.struct, trial_set, why), why)
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
    rolling: npt.ArrayLike | None = None,
    seen: npt.ArrayLike | None = None,
) -> Replay:
    """Drive logged commands through the point model, all runs and robots in one call.

    The command chain is integrated once; the motion over any window is the difference of two poses.

    Args:
        t: (rows,) s, increasing within a segment.
        commands: (rows, 2) rad/s left and right, valid from their row's time to the next.
        start: (segments + 1,) first row of each segment (one run of one robot), and the row count.
        initial: (segments, 3) pose at each segment's first row.
        drive: The motion model.
        rolling: (segments, 2) rad/s at which wheels turn at first and until a command has arrived;
            None: at rest.
        seen: (rows, 4) where laws find the robot from each row on: x, y (m), yaw (rad), distance to
            the next robot's middle (m); None: where the replay has it, and alone.

    Raises:
        InputError: shapes disagree, times fall, or a number is out of range; says which row.
        Diverged: a pose left the finite numbers; says which row.
    """
    times = array("t", t, np.float64, (None,))
    rows = len(times)
    command = array("commands", commands, np.float64, (rows, 2))
    starts = array("start", start, np.int64, (None,))
    if not len(starts):
        raise InputError("start", "nothing", f"increasing rows from 0 to {rows}")
    segments = len(starts) - 1
    first = array("initial", initial, np.float64, (segments, 3))
    began = None if rolling is None else array("rolling", rolling, np.float64, (segments, 2))
    around = None if seen is None else array("seen", seen, np.float64, (rows, 4))
    result = Replay(np.empty((rows, 3)), np.empty((rows, 2)))
    why = refusal()
    status = lib.rg_replay(
        drive.struct(),
        rows,
        segments,
        memory("int64_t[]", starts),
        memory("double[]", times),
        memory("double[]", command),
        memory("double[]", first),
        ffi.NULL if began is None else memory("double[]", began),
        memory("double[]", result.poses),
        memory("double[]", result.speeds),
        ffi.NULL if around is None else memory("double[]", around),
        why,
    )
    check(status, why)
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
        InputError: shapes disagree, the model has no sensor tables or cannot be used, or a number
            is out of range; says which row.
    """
    pose = array("poses", poses, np.float64, (None, 3))
    rows = len(pose)
    scenario = array("scenarios", scenarios, np.int32, (rows,))
    times = np.zeros(rows) if t is None else array("t", t, np.float64, (rows,))
    result = Readings(np.empty((rows, SENSORS)), np.empty((rows, SENSORS)))
    why = refusal()
    status = lib.rg_readings(
        model.struct,
        rows,
        memory("double[]", pose),
        memory("int32_t[]", scenario),
        memory("double[]", times),
        memory("double[]", result.ps),
        memory("double[]", result.ls),
        why,
    )
    check(status, why)
    return result
