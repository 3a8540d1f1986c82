"""From a measured log to a diagnosis: cut, identify, look for what is left, weigh the claims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.models.belief.catalogue import causes, without
from realitygap.models.belief.causes.motors import least_seen
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.conditions import conditions
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.preflight.colour import may_be_filtered
from realitygap.models.naming.channels.motion.claims import claimed
from realitygap.models.naming.channels.motion.examination import Examination
from realitygap.models.naming.channels.motion.identify import identify
from realitygap.models.naming.channels.motion.leftover import leftover
from realitygap.models.naming.channels.motion.tracks import Tracks, cut_tracks
from realitygap.models.naming.channels.motion.unmeasured import unmeasured
from realitygap.models.naming.channels.wheels.chosen import before_the_encoders, driven_by_encoders
from realitygap.models.naming.channels.wheels.obeyed import obeyed
from realitygap.models.naming.claims.calibration import with_calibration
from realitygap.models.naming.diagnosis import Diagnosis
from realitygap.models.naming.findings import Identified
from realitygap.models.naming.health.reference import Reference, no_reference
from realitygap.models.naming.laws.told import with_laws
from realitygap.models.naming.preflight import preflight
from realitygap.models.naming.rules import Rules

KNOWN = 0.9
"""Share of rows whose encoders must be known for them to stand for commands. No rule: a lost row
is bridged by the one before."""


def diagnose(
    log: MeasuredLog,
    model: ModelFile,
    reference: Reference | None,
    *,
    rules: Rules = Rules(),
    seed: int = 0,
    name: str = "model",
) -> Examination:
    """Say what is wrong with the robots of a log.

    Args:
        log: Measured.
        model: What the simulator believes.
        reference: What healthy robots do; None: nobody knows.
        rules: What naming is tuned to.
        seed: Of the bootstrap.
        name: What to call the model's file in an error.

    Raises:
        InputError: nothing in the log can be used, or the model's extension concerns a robot that
            the log does not have.
    """
    table = conditions(log, model)
    replayed = replay_log(log, model.point_model().drive)
    tracks = replace(
        cut_tracks(log, model, table=table, rules=rules), filtered=may_be_filtered(log, replayed)
    )
    if model.extension is not None:
        model.extension.check_robots(tracks.robots, name)
    believed = [model.motion(robot) for robot in tracks.robots]
    healthy = (
        no_reference(model.name, model.motion().drive, rules) if reference is None else reference
    )
    alike = healthy.recorded_like(log.recorder, log.step)
    logged, in_two = tracks, reference is None and _counted(tracks)
    if in_two:
        found, tracks = _in_two(logged, healthy, believed)
    else:
        found = identify(tracks, healthy, believed, alike=alike)
    examined = Examination(
        tracks=tracks,
        model=model,
        reference=healthy,
        identified=found,
        diagnosis=Diagnosis(
            named=found.named,
            unexplained=leftover(tracks, found),
            not_checked=(
                *_not_checked(logged, reference),
                *unmeasured(tracks, found.base, healthy, found.away),
            ),
            preflight=preflight(
                log,
                model,
                replayed,
                noise=tracks.noise,
                used=tracks.used,
                reference=healthy,
                recording=found.recording,
            ),
            notes=log.notes,
            robots=tracks.robots,
            rules=rules,
            reference="" if reference is None else reference.model,
        ),
    )
    whole = claimed(examined, log, table, seed=seed)
    if in_two:
        whole = replace(whole, diagnosis=_behind_the_encoders(whole.diagnosis))
    return with_calibration(with_laws(whole, log, table), log, table)


def _counted(tracks: Tracks) -> bool:
    """Whether the encoders of every robot's every run are known, but for a row here and there."""
    if tracks.encoders is None:
        return False
    known = np.isfinite(tracks.encoders).all(axis=1).astype(np.float64)
    share = np.add.reduceat(known, tracks.start[:-1]) / np.diff(tracks.start)
    return bool((share > KNOWN).all())


def _in_two(
    tracks: Tracks, healthy: Reference, believed: Sequence[Motion]
) -> tuple[Identified, Tracks]:
    """What is wrong before the encoders and what behind them, and the tracks of the latter.

    Only of robots whose health is unknown: a reference knows the whole chain, not its halves.
    """
    motors = obeyed(tracks, believed)
    driven, free = driven_by_encoders(tracks, believed)
    with without(c.name for c in causes().values() if before_the_encoders(c)):
        found = identify(driven, healthy, free)
    return replace(found, named=(*motors.named, *found.named), by_part=motors.by_part), driven


def _behind_the_encoders(said: Diagnosis) -> Diagnosis:
    """Without sizes that poses would have shown of causes that the encoders tell."""
    told = {c.name for c in causes().values() if before_the_encoders(c)}
    untold = {r: tuple(n for n in names if n not in told) for r, names in said.untold.items()}
    return replace(
        said,
        detectable=tuple(one for one in said.detectable if one.cause not in told),
        untold={robot: names for robot, names in untold.items() if names},
    )


def _not_checked(tracks: Tracks, reference: Reference | None) -> tuple[str, ...]:
    """What this log cannot say, in words."""
    said = []
    if reference is None:
        said.append(
            "no healthy reference: what every robot of this kind does (slip, finite torque, "
            "latency) is named like a fault, and how much healthy robots differ is not known"
        )
    said += _too_little(tracks)
    if tracks.encoders is None:
        pairs = sorted(
            {
                tuple(sorted((c.name, t)))
                for c in causes().values()
                for t in c.twins
                if c.separated_by
            }
        )
        said += [f"no encoders: {a} and {b} cannot be told apart" for a, b in pairs]
    slowest = least_seen(tracks.commands)
    said.append(
        f"motor_dead_zone below {slowest:.2g} rad/s: so slow commands are too rare in this log"
        if np.isfinite(slowest)
        else "motor_dead_zone: no slow commands in this log"
    )
    said += [f"{c.name}: {c.meaning}" for c in causes().values() if not c.identifiable]
    return tuple(said)


def _too_little(tracks: Tracks) -> list[str]:
    """Robots that moved too little to be called sound."""
    least = tracks.rules.few_seconds
    told = np.any(tracks.commands[tracks.rows[tracks.first]] != 0.0, axis=1)
    took = tracks.t[np.append(tracks.rows[tracks.first[1:] - 1], tracks.rows[-1])]
    seconds = (took - tracks.t[tracks.rows[tracks.first]]) * told
    moved = np.bincount(tracks.robot, seconds, len(tracks.robots))
    few = ", ".join(str(r) for r, s in zip(tracks.robots, moved, strict=True) if s < least)
    if not few:
        return []
    return [
        f"motion of robots {few}: less than {least:g} s of free motion under a command, in "
        "which only gross faults show"
    ]
