"""From a measured log to what is wrong with sensors, lamps and the nest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import sense_causes
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief
from realitygap.models.gap.sensing import scenarios
from realitygap.models.gap.stood import poses_as_stood
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.schema import LS, POSE, PS
from realitygap.models.naming.channels.motion.fitted import Values
from realitygap.models.naming.channels.senses.identify import SensesFound, by_part, identify
from realitygap.models.naming.channels.senses.leap import elsewhere, far_lamps
from realitygap.models.naming.channels.senses.leftover import detectable_in, leftover, unmeasured
from realitygap.models.naming.channels.senses.nest import Answers, answers
from realitygap.models.naming.channels.senses.robot import TARGETS, SenseLog
from realitygap.models.naming.channels.senses.sight import Rows, Sight, look
from realitygap.models.naming.channels.senses.terms import Doses
from realitygap.models.naming.diagnosis import Detectable, Unexplained
from realitygap.models.naming.findings import Named
from realitygap.models.naming.health.senses import SenseReference, no_sense_reference
from realitygap.models.naming.rules import Rules


@dataclass(frozen=True, eq=False, kw_only=True)
class SenseExamination:
    """What was found in the senses, and what it was drawn from."""

    named: tuple[Named, ...] = ()
    not_checked: tuple[str, ...] = ()
    sight: Sight | None = None
    """None where no sensor could be judged."""
    found: SensesFound | None = None
    """None where neither sensors nor the nest could be."""
    unexplained: tuple[Unexplained, ...] = ()
    reference: SenseReference | None = None
    """What health was taken from."""
    by_part: tuple[Values, ...] = ({}, {})
    """The names' values that each part of the log gives by itself."""
    detectable: tuple[Detectable, ...] = ()
    """What the log would have shown."""
    answers: Answers | None = None
    """Of the virtual sensor about the nest."""
    answers_part: Rows = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """(answers,) part of the log of each."""

    @property
    def away(self) -> dict[str, FloatArray]:
        """(robots,) by channel and quantity, distance from health of what follows it."""
        return {} if self.found is None else self.found.away


def diagnose_senses(
    log: MeasuredLog,
    model: PointModel,
    reference: SenseReference | None,
    *,
    believed: Mapping[int, Belief] | None = None,
    seen: Mapping[int, tuple[Motion, Motion]] | None = None,
    moved: Mapping[int, Motion] | None = None,
    alike: bool = True,
    rules: Rules = Rules(),
) -> SenseExamination:
    """Say what is wrong with the senses of the robots of a log.

    Args:
        log: Measured.
        model: What the simulator believes.
        reference: What healthy robots' senses do; None: nobody knows.
        believed: What the simulator believes of single robots, by id.
        seen: As for `look`: robots whose markers motion has found askew.
        moved: As for `look`: robots in whose motion something was named.
        alike: Whether the log was recorded as those of the reference were.
        rules: What naming is tuned to.
    """
    healthy = no_sense_reference("") if reference is None else reference
    missing = _missing(log, model, reference)
    if "nest" not in log.frame:
        missing.append("no nest: nest_moved, nest_radius")
    part = parts(log)
    stood = _as_stood(log, model, seen or {})
    told = answers(stood)
    judged = model.tables is not None and any(name in log.frame for name in (*PS, *LS))
    if not judged and told is None:
        return SenseExamination(not_checked=tuple(missing))
    sight = look(log, model, seen, moved=moved, rules=rules) if judged else None
    robots = sense_log(stood, model, healthy, sight, part, believed or {}, rules)
    own = _believed(robots.robots, model, believed or {})
    begun = None
    if sight is not None:
        begun = elsewhere(
            sight, model, _believed(sight.robots, model, believed or {}), robots.doses
        )
    found = identify(robots, healthy, own, alike=alike, begun=begun)
    missing += _uncrossed(found)
    missing += unmeasured(found.state.robots[0].names, found.state.items, healthy)
    return SenseExamination(
        named=found.named,
        unexplained=leftover(found),
        not_checked=tuple(missing),
        sight=sight,
        found=found,
        reference=healthy,
        by_part=by_part(found) if found.named else ({}, {}),
        detectable=detectable_in(found),
        answers=told,
        answers_part=np.zeros(0, dtype=np.int64) if told is None else part[told.rows],
    )


def _as_stood(
    log: MeasuredLog, model: PointModel, seen: Mapping[int, tuple[Motion, Motion]]
) -> MeasuredLog:
    """The log with the robots' own poses, out of measured ones; `seen` as for `look`."""
    if not seen:
        return log
    poses = poses_as_stood(log, model, np.arange(len(log.t)), log.poses, seen)
    return replace(log, frame=log.frame.assign(**dict(zip(POSE, poses.T, strict=True))))


def sense_log(
    log: MeasuredLog,
    model: PointModel,
    healthy: SenseReference,
    sight: Sight | None,
    part: Rows,
    believed: Mapping[int, Belief],
    rules: Rules = Rules(),
) -> SenseLog:
    """A log as the senses are judged by it, with the lamps that may stand somewhere else."""
    doses: Doses = {}
    if sight is not None:
        doses = far_lamps(sight, model, _believed(sight.robots, model, believed))
    return SenseLog(
        log,
        model,
        sight,
        of_log=part,
        doses=doses,
        robots_seen=TARGETS in healthy.columns,
        rules=rules,
    )


def _believed(
    robots: Sequence[int], model: PointModel, believed: Mapping[int, Belief]
) -> list[Belief]:
    common = Belief(senses=model.senses)
    return [believed.get(robot, common) for robot in robots]


def _uncrossed(found: SensesFound) -> list[str]:
    """Whose answers say nothing of the nest by themselves."""
    names = found.state.robots[0].names
    at = [k for k, name in enumerate(names) if name.startswith("nest_")]
    robots = zip(found.state.tracks.robots, found.state.robots, strict=True)
    silent = [str(r) for r, one in robots if not np.diag(one.information)[at].any()]
    if not silent:
        return []
    return [
        f"nest_moved, nest_radius of robots {', '.join(silent)} by themselves: they never crossed "
        "the nest's edge"
    ]


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
            silenced = [
                c.name for c in sense_causes().values() if c.columns[0].startswith(kinds[columns])
            ]
            said.append(f"no {columns}: {', '.join(silenced)}")
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
