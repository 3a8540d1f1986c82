"""One diagnosis out of what motion and senses show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from realitygap.embedded_sim import PointModel, Tables
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.channels.motion.claims import claimed
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.channels.senses.claims import sense_claims
from realitygap.models.naming.channels.senses.clock import TWINS, shifts, swapped, told_apart
from realitygap.models.naming.channels.senses.diagnose import SenseExamination, diagnose_senses
from realitygap.models.naming.channels.senses.robot import LATE, SenseLog
from realitygap.models.naming.channels.senses.sight import look
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.findings import Named
from realitygap.models.naming.health.reference import Column
from realitygap.models.naming.health.senses import SenseReference, no_sense_reference

MARKERS = ("tracker_yaw_offset", "tracker_offset", "clock_offset")
"""Causes in motion that put the measured pose beside the true one."""
NEVER = Column(mean=0.0, sd=0.0, swarm_sd=0.0)
"""How late a healthy robot's poses are believed to be where nobody measured it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WholeExamination(Examination):
    """A diagnosis of motion and senses, and what it was drawn from."""

    senses: SenseExamination


def with_senses(
    examined: Examination,
    log: MeasuredLog,
    tables: Tables | None,
    reference: SenseReference | None,
    *,
    seed: int = 0,
) -> WholeExamination:
    """An examination of motion with everything the senses show added to its diagnosis.

    Args:
        examined: Of the same log.
        log: Measured.
        tables: Captured, of the model; None: its sensors are not modelled.
        reference: What healthy robots' senses do; None: nobody knows.
        seed: Of the bootstrap.
    """
    model = examined.model
    robots = examined.tracks.robots
    believed = {}
    if model.extension is not None:
        believed = {r: Belief(senses=model.extension.sensed(r).senses) for r in robots}
    point = model.point_model(tables)
    examined = _clocks_told_apart(examined, log, point, reference, believed, seed)
    found = examined.diagnosis
    senses = diagnose_senses(
        log,
        point,
        reference,
        believed=believed,
        seen=_askew(examined),
        alike=examined.identified.alike,
        moved=_moved(examined),
        rules=found.rules,
    )
    named, ended, gain = sense_claims(senses, model, tables, found.rules, seed=seed)
    joined = replace(
        found,
        named=(*found.named, *named),
        unexplained=(*found.unexplained, *senses.unexplained, *ended),
        not_checked=(*found.not_checked, *senses.not_checked),
        gain={**found.gain, **gain},
        detectable=(*found.detectable, *senses.detectable),
    )
    kept = {one.name: getattr(examined, one.name) for one in fields(examined)}
    return WholeExamination(**{**kept, "diagnosis": joined}, senses=senses)


def _clocks_told_apart(
    examined: Examination,
    log: MeasuredLog,
    model: PointModel,
    reference: SenseReference | None,
    believed: Mapping[int, Belief],
    seed: int,
) -> Examination:
    """The same, with the sensors' word on whether a robot or its tracker is late."""
    identified, found = examined.identified, examined.diagnosis
    seen = model.tables is not None and any(name in log.frame for name in (*PS, *LS))
    if not seen:
        return examined
    healthy = no_sense_reference("") if reference is None else reference
    names = [one.term.cause.name for one in found.named]
    explained = dict(zip(examined.tracks.robots, identified.explained, strict=True))
    told: list[Named | Unexplained] = list(found.named)
    if set(names) & set(TWINS):
        robots = SenseLog(
            log, model, look(log, model, rules=found.rules), of_log=parts(log), rules=found.rules
        )
        common = Belief(senses=model.senses)
        base = [believed.get(robot, common) for robot in robots.robots]
        shift = shifts(robots.at(range(len(base)), base), healthy.learned)
        late = healthy.columns.get(LATE) if healthy.robots else NEVER
        told = [told_apart(o, robots.robots, shift, late, found.rules) for o in found.named]
        for old, new in zip(found.named, told, strict=True):
            if isinstance(new, Named):
                swap = {robot: swapped(explained[robot], old, new) for robot in new.robots}
                explained.update(swap)
    kept = tuple(one for one in told if isinstance(one, Named))
    left = tuple(one for one in told if isinstance(one, Unexplained))
    both = " and ".join(sorted(TWINS))
    changed = replace(
        examined,
        identified=replace(identified, named=kept, explained=tuple(explained.values())),
        diagnosis=replace(
            found,
            named=kept,
            unexplained=(*found.unexplained, *left),
            not_checked=tuple(text for text in found.not_checked if both not in text),
        ),
    )
    return claimed(changed, log, seed=seed) if left else changed


def _moved(examined: Examination) -> dict[int, Motion]:
    """Motion found in the robots for which a cause is named."""
    found = examined.identified
    named = {robot for one in found.named for robot in one.robots}
    robots = examined.tracks.robots
    return {robot: found.explained[k] for k, robot in enumerate(robots) if robot in named}


def _askew(examined: Examination) -> dict[int, tuple[Motion, Motion]]:
    """Healthy and found motion of the robots whose marker or tracker's clock is off: motion has
    named it, or the model's extension says so."""
    found = examined.identified
    named = {robot for one in found.named if one.term.cause.name in MARKERS for robot in one.robots}
    askew = {}
    for k, robot in enumerate(examined.tracks.robots):
        believed = examined.model.motion(robot)
        own = any((*believed.lever, believed.yaw_offset, believed.pose_delay))
        if robot in named or own or not found.alike:
            healthy = examined.reference.motion(believed)
            # what delays all rows may be the commands', which the sensors do not wait for
            healthy = replace(healthy, pose_delay=found.base[k].pose_delay)
            askew[robot] = (_without(healthy, believed), found.explained[k])
    return askew


def _without(healthy: Motion, believed: Motion) -> Motion:
    """A healthy robot's motion, its marker and clock as they would be without what is believed."""
    ahead, left = (a - b for a, b in zip(healthy.lever, believed.lever, strict=True))
    return replace(
        healthy,
        lever=(ahead, left),
        yaw_offset=healthy.yaw_offset - believed.yaw_offset,
        pose_delay=healthy.pose_delay - believed.pose_delay,
    )
