"""From a measured log to what is wrong with sensors, lamps and the nest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.diagnosis import Detectable, Unexplained
from realitygap.models.held_out import parts
from realitygap.models.identify.fitted import Values
from realitygap.models.log import MeasuredLog
from realitygap.models.naming.findings import Named
from realitygap.models.schema import LS, PS
from realitygap.models.senses import nest
from realitygap.models.senses.cause import Belief
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.detectable import detectable_in
from realitygap.models.senses.direct import Scale, dead_infrared, dead_light, noise_scale, of_robots
from realitygap.models.senses.lack_of_fit import Noisy, judge
from realitygap.models.senses.leap import far_leap
from realitygap.models.senses.naming import dead_named, fitted_named, nest_named, noise_named
from realitygap.models.senses.predicted import predict
from realitygap.models.senses.problem import SWARM, Fit, Problem, Term
from realitygap.models.senses.reference import SenseReference, no_sense_reference
from realitygap.models.senses.refit import noise_values, of_fit, of_nest, of_noise
from realitygap.models.senses.select import Found, choose
from realitygap.models.senses.sight import Bools, Rows, Sight, look
from realitygap.models.senses.structure import Follow
from realitygap.models.senses.unmeasured import unmeasured_causes, unmeasured_structure
from realitygap.models.senses.unnamed import named_or_not
from realitygap.models.sensing import scenarios

LEAST_SWARM = 3
NOISY = 0.8
"""Share of the robots that must be noisier for the swarm to be."""
FAR = 3.0
"""Standard deviations at which a robot counts as noisier, where the swarm is asked for."""
LEAST_ERROR = 1e-3
"""Relative: readings of other robots are never taken to be surer."""
MOST_LOOKS = 2
"""Times that causes are chosen: a fault that was first taken for noise hides what is beside it."""
OTHERWISE = 0.2
"""Change of the noise's scale, a logarithm, with which causes are chosen again. Our choice: noise
that is believed a fifth too large costs a third of the evidence."""
AGREES, DISAGREES = 3.0, 4.0
"""Standard deviations within which, and beyond which, readings of other robots decide between the
wall and the sensors."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SenseExamination:
    """What was found in the senses, and what it was drawn from."""

    named: tuple[Named, ...] = ()
    not_checked: tuple[str, ...] = ()
    sight: Sight | None = None
    problem: Problem | None = None
    fit: Fit | None = None
    """With every named term; None where no sensor could be judged."""
    unexplained: tuple[Unexplained, ...] = ()
    structure: tuple[Follow, ...] = ()
    """Every flexible term beside those."""
    reference: SenseReference | None = None
    """What health was taken from."""
    by_part: tuple[Values, ...] = ({}, {})
    """The names' values that each part of the log gives by itself."""
    scatter: FloatArray | None = None
    """(parts, robots) logarithm of the infrared noise's scale over the healthy one in each part;
    None: none is named."""
    detectable: tuple[Detectable, ...] = ()
    """What the readings would have shown."""
    answers: nest.Answers | None = None
    """Of the virtual sensor about the nest."""
    answers_part: Rows = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """(answers,) part of the log of each."""


def diagnose_senses(
    log: MeasuredLog,
    model: PointModel,
    reference: SenseReference | None,
    *,
    believed: Mapping[int, Belief] | None = None,
    seen: Mapping[int, tuple[Motion, Motion]] | None = None,
    moved: Mapping[int, Motion] | None = None,
) -> SenseExamination:
    """Say what is wrong with the senses of the robots of a log.

    Args:
        log: Measured.
        model: What the simulator believes.
        reference: What healthy robots' senses do; None: nobody knows.
        believed: What the simulator believes of single robots, by id.
        seen: As for `look`: robots whose markers motion has found askew.
        moved: As for `look`: robots in whose motion something was named.
    """
    healthy = no_sense_reference("") if reference is None else reference
    missing = [*_missing(log, model, reference), *unmeasured_causes(log, model, healthy)]
    answers = nest.answers(log)
    nests = _nest(answers, model, missing)
    part = np.zeros(0, dtype=np.int64) if answers is None else parts(log)[answers.rows]
    by_part = of_nest(answers, part, model.nest, nests)
    named = nest_named(nests)
    if model.tables is None or not any(name in log.frame for name in (*PS, *LS)):
        named, unnamed = named_or_not(named)
        return SenseExamination(
            named=named,
            unexplained=unnamed,
            not_checked=tuple(missing),
            by_part=by_part,
            answers=answers,
            answers_part=part,
        )
    sight = look(log, model, seen, moved=moved)
    common = Belief(senses=model.senses)
    base = [healthy.base((believed or {}).get(robot, common)) for robot in sight.robots]
    expected = predict(sight, model, base)
    blind = _blind(sight, model, expected, expected, healthy)
    use = sight.free & ~blind[sight.robot]
    leap = far_leap(Problem(sight, model, base, use))
    if leap is not None:  # which sensors should have seen light depends on where it comes from
        lit = predict(sight, model, [leap.believed(b) for b in base])
        blind = _blind(sight, model, expected, lit, healthy)
        use = sight.free & ~blind[sight.robot]
    noisy = _noise(sight, model, base, expected, use, healthy)
    for _ in range(MOST_LOOKS):
        problem = Problem(sight, model, _noisier(base, noisy), use)
        chosen = choose(problem, healthy, leap)
        # what a fault explains is no noise
        told = problem.beliefs(chosen.fit.terms, chosen.fit.coordinates)
        after = _noisier(told, noisy, by=-1.0)
        before, noisy = noisy, _noise(sight, model, after, expected, use, healthy)
        if all(abs(u - v) < OTHERWISE for (u, *_), (v, *_) in zip(before, noisy, strict=True)):
            break
    judged = judge(problem, chosen, healthy)
    found = [_wall_or_sensors(one, problem, judged.fit, healthy) for one in judged.found]
    named += fitted_named(found, sight.robots, healthy)
    dead = dead_named(blind, sight.robots)
    believed_noisy = judged.believable(noisy)
    named += dead + noise_named(believed_noisy, sight.robots)
    both = tuple((one.term, other) for one, other in zip(judged.found, found, strict=True))
    of_parts = [by_part, of_fit(problem, judged.fit, both, healthy)]
    of_parts.append(tuple({one.key: one.values for one in dead} for _ in by_part))
    scatter = None
    if any(u != 0.0 for u, *_ in believed_noisy):
        scatter = of_noise(Problem(sight, model, after, use), expected, healthy)
        of_parts.append(noise_values(scatter, believed_noisy, sight))
    named, unnamed = named_or_not(named)
    return SenseExamination(
        named=named,
        unexplained=(*judged.unexplained, *unnamed),
        not_checked=(*missing, *unmeasured_structure(judged.structure, healthy)),
        sight=sight,
        problem=problem,
        fit=judged.fit,
        structure=judged.structure,
        reference=healthy,
        by_part=_merged(of_parts),
        scatter=scatter,
        detectable=detectable_in(chosen.promises, judged.fit, sight, healthy),
        answers=answers,
        answers_part=part,
    )


def _merged(found: Sequence[Sequence[Values]]) -> tuple[Values, ...]:
    """By part of the log, the values of all kinds of causes."""
    return tuple(
        {k: v for one in part for k, v in one.items()} for part in zip(*found, strict=True)
    )


def _blind(
    sight: Sight, model: PointModel, expected: FloatArray, lit: FloatArray, healthy: SenseReference
) -> Bools:
    """(robots, 16) sensors that are dead, by the (rows, 16) counts expected and those with the lamp
    where it is."""
    infrared = dead_infrared(sight, expected, healthy.silent)
    return np.hstack([infrared, dead_light(sight, lit, model)])


def _missing(log: MeasuredLog, model: PointModel, reference: SenseReference | None) -> list[str]:
    """What this log cannot say of the senses, in words."""
    said = []
    if model.tables is None:
        return ["sensors: the model has no captured tables: neither infrared nor light is judged"]
    absent = {
        "ps0..ps7": not any(name in log.frame for name in PS),
        "ls0..ls7": not any(name in log.frame for name in LS),
    }
    kinds = {"ps0..ps7": "ps", "ls0..ls7": "ls"}
    for columns, gone in absent.items():
        if gone:
            silent = [
                c.name for c in sense_causes().values() if c.columns[0].startswith(kinds[columns])
            ]
            said.append(f"no {columns}: {', '.join(silent)}")
    if all(absent.values()):
        said.append(
            "no ps0..ps7 and no ls0..ls7: a late tracker and late commands (clock_offset, "
            "command_latency) are told apart by encoders alone, a rotated marker "
            "(tracker_yaw_offset) by motion alone, and a turned ring of sensors (ir_rotation) "
            "is not seen"
        )
    if not absent["ls0..ls7"] and not (scenarios(log) >= 0).any():
        said.append(
            "no case, or one that switches: where the lamp stood is not known, so that no "
            "cause in the light is judged"
        )
    if reference is None and not all(absent.values()):
        said.append(
            "no healthy reference of the senses: what the captured tables leave out in every robot "
            "is named like a fault"
        )
    return said


def _nest(
    answers: nest.Answers | None, model: PointModel, missing: list[str]
) -> list[nest.NestFound]:
    """What is wrong with the nest; says whose answers say nothing."""
    if answers is None:
        missing.append("no nest: nest_moved, nest_radius")
        return []
    silent = sorted(set(np.unique(answers.robot).tolist()) - set(nest.crossed(answers)))
    if silent:
        robots = ", ".join(map(str, silent))
        missing.append(
            f"nest_moved, nest_radius of robots {robots} by themselves: they crossed the nest's "
            f"edge less than {nest.LEAST_CROSSINGS} times"
        )
    return nest.find(answers, model.nest)


def _noise(
    sight: Sight,
    model: PointModel,
    beliefs: list[Belief],
    expected: FloatArray,
    use: Bools,
    healthy: SenseReference,
) -> Noisy:
    """Per robot: logarithm of the noise's scale over the healthy one, its error, swarm-wide?

    The scale is 0 where it is healthy. `expected` (rows, 16) are a healthy robot's counts: which
    readings tell of noise must not depend on the faults found.
    """
    level = healthy.noise
    if level is None:
        return [(0.0, np.inf, False)] * len(sight.robots)
    plain = Problem(sight, model, beliefs, use)
    residual = plain.residual((), np.zeros(0))
    scale = noise_scale(sight, residual, expected, use)
    value, error = scale.value - level.mean, np.hypot(scale.error, level.sd)
    known = np.isfinite(value)
    shared = 0.0
    if known.sum() >= LEAST_SWARM:
        middle = float(np.median(value[known]))
        sure = np.hypot(level.swarm_sd, 1.2533 * np.median(error[known]) / np.sqrt(known.sum()))
        gate = max(healthy.distance, healthy.margin * level.swarm_farthest)
        alike = float(np.mean(np.abs(value[known] / error[known]) > FAR))
        if abs(middle) > gate * sure and alike >= NOISY:
            shared = middle
    gate = max(healthy.distance, healthy.margin * level.farthest)
    rest = np.where(known, value - shared, 0.0)
    own = np.where(np.abs(rest) > gate * error, rest, 0.0)
    wide = Scale(shared + own, error)
    return [
        (float(u), float(e), bool(shared != 0.0 and o == 0.0))
        for u, e, o in zip(wide.value, wide.error, own, strict=True)
    ]


def _noisier(beliefs: Sequence[Belief], noisy: Noisy, by: float = 1.0) -> list[Belief]:
    """Beliefs with each robot's noise scaled, or with `by=-1` no longer."""
    return [
        replace(b, senses=replace(b.senses, ps_noise=b.senses.ps_noise * float(np.exp(by * u))))
        for b, (u, _, _) in zip(beliefs, noisy, strict=True)
    ]


def _wall_or_sensors(one: Found, problem: Problem, fit: Fit, healthy: SenseReference) -> Found:
    """A gain of all sensors of all robots: is it the wall's? Readings of other robots decide."""
    names = ("ir_gain", "wall_albedo")
    name = one.term.cause.name
    if name not in names or one.term.robot != SWARM or one.term.variant not in ("", "all"):
        return one
    albedo, gain = Term(sense_causes()["wall_albedo"]), Term(sense_causes()["ir_gain"], "all")
    sight, model = problem.sight, problem.model
    counts = predict(sight, model, problem.beliefs(fit.terms, fit.coordinates))
    told, error = of_robots(sight, model, counts, np.isfinite(sight.read[:, :SENSORS]))
    mean, sd = healthy.spread(one.term.key, 1, swarm=True)
    size, size_error = float(one.coordinates[0] - mean[0]), float(np.hypot(one.error[0], sd[0]))
    usual = healthy.targets
    if usual is None or not np.isfinite(told):
        return replace(one, term=albedo, rivals=(gain,))
    wide = max(float(np.hypot(error, usual.swarm_sd)), LEAST_ERROR)
    of_wall = abs(told - usual.mean) / wide
    of_sensors = abs(told - usual.mean - size) / np.hypot(wide, size_error)
    rivals = tuple(t for t in one.rivals if t.cause.name not in names)
    if of_wall < AGREES and of_sensors > DISAGREES:
        return replace(one, term=albedo, rivals=rivals)
    if of_sensors < AGREES and of_wall > DISAGREES:
        return replace(one, term=gain, rivals=rivals)
    first, second = (albedo, gain) if of_wall < of_sensors else (gain, albedo)
    return replace(one, term=first, rivals=(second, *rivals))
