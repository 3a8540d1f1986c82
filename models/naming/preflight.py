"""The pre-flight: what a log can tell, stated with what a diagnosis makes of it, before any name.

Nothing is decided here. A measured value that troubles nothing is told as one that does.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes, sense_causes
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise
from realitygap.models.log.preflight.colour import colour
from realitygap.models.log.preflight.entry import PreflightEntry
from realitygap.models.log.preflight.poses import facing, failures, steps_of
from realitygap.models.log.preflight.stamps import commands, stamps
from realitygap.models.log.schema import ENCODERS, LS, PS
from realitygap.models.log.used import Used
from realitygap.models.naming.channels.motion.recording import TRANSIENT
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.health.reference import Reference

HEADINGS = ("tracker_offset", "tracker_yaw_offset")
"""Causes that only measured headings show: a course is that of the marker itself."""
RECORDING = {
    "delay": ("s", "by which poses are late, beyond what healthy robots show"),
    "rate": ("1", "by which the poses' clock and the commands' drift apart"),
    "smear": ("s^2", "variance of the times that a pose averages, or a command is lost among"),
    "scale": ("1", "factor of the tracker's metre"),
    "lag": ("s", "time constant of a causal filter of poses, where their noise hangs together"),
}
"""What is fitted of how a log was recorded (`motion.recording`)."""


def preflight(
    log: MeasuredLog,
    model: ModelFile,
    replayed: FloatArray,
    *,
    noise: PoseNoise,
    used: Sequence[Used],
    reference: Reference,
    recording: Sequence[Value],
) -> tuple[PreflightEntry, ...]:
    """What a log can tell.

    Args:
        log: Measured.
        model: What the simulator believes.
        replayed: (rows, 3) the log's commands through the model.
        noise: Of the tracker.
        used: How much of each robot's time a diagnosis uses.
        reference: What healthy robots do; of no robots where nobody knows.
        recording: How the log was recorded, where that was fitted.
    """
    alike = reference.recorded_like(log.recorder, log.step)
    fitted = reference.robots > 0 and not alike
    return (
        _share(used),
        *_of_time(log),
        *_of_commands(log, fitted),
        *_of_tracker(log, replayed, noise),
        *_of_frame(log, model, noise),
        *_of_recording(recording, alike, reference.robots > 0),
        *_of_reference(log, reference, alike),
        *_columns(log),
    )


def _share(used: Sequence[Used]) -> PreflightEntry:
    seconds = sum(one.seconds for one in used)
    share = sum(one.seconds * one.used for one in used) / seconds if seconds else 0.0
    return PreflightEntry(
        name="used",
        meaning="share of all robots' time that is in windows",
        value=share,
        unit="1",
        why="the rest is in no window of motion; robot by robot it is said why",
    )


def _of_time(log: MeasuredLog) -> Iterator[PreflightEntry]:
    found = stamps(log)
    yield PreflightEntry(
        name="row_rate", meaning="rows of a robot", value=found.row_rate, unit="Hz"
    )
    yield PreflightEntry(
        name="pose_rate", meaning="new poses of a robot", value=found.pose_rate, unit="Hz"
    )
    yield PreflightEntry(
        name="stamp_jitter",
        meaning="standard deviation of a row's time about even times",
        value=found.jitter,
        unit="s",
        follows="repaired" if log.jitter else "nothing",
        why="the motion is even: rows are replayed at even times"
        if log.jitter
        else "rows are replayed at the times they give",
    )
    yield _repaired(
        "held_poses",
        "share of moving robots' rows that repeat the pose before",
        found.repeats,
        "each pose is used once",
        done=bool(log.held.any()),
    )
    yield _repaired(
        "no_pose",
        "share of rows without a pose, held ones aside",
        found.without,
        "the command goes on between the poses there are",
    )
    yield _repaired(
        "gaps",
        "places where rows are missing or the track jumps",
        found.gaps,
        "nothing is replayed across them",
    )


def _repaired(
    name: str, meaning: str, value: float, why: str, *, done: bool = True
) -> PreflightEntry:
    """Something that is repaired where it is, if that is done."""
    if not value or not done:
        return PreflightEntry(name=name, meaning=meaning, value=value, unit="1")
    return PreflightEntry(
        name=name, meaning=meaning, value=value, unit="1", follows="repaired", why=why
    )


def _of_commands(log: MeasuredLog, fitted: bool) -> Iterator[PreflightEntry]:
    found = commands(log)
    yield PreflightEntry(
        name="command_changes", meaning="changes of a robot's command", value=found.rate, unit="Hz"
    )
    shown = bool(found.together)
    yield PreflightEntry(
        name="commands_in_every_row",
        meaning="share of changes that another follows in the next row: "
        "the more, the likelier that rows miss some",
        value=found.together,
        unit="1",
        follows="modelled" if fitted and shown else "nothing",
        why="a delay and a smear of all robots stand for what rows do not show"
        if fitted and shown
        else "",
    )


def _of_tracker(
    log: MeasuredLog, replayed: FloatArray, noise: PoseNoise
) -> Iterator[PreflightEntry]:
    units = {"position": "m", "heading": "rad"}
    steps, colours = steps_of(log), colour(log, replayed)
    for (what, unit), sd, step, own in zip(units.items(), noise, steps, colours, strict=True):
        yield PreflightEntry(
            name=f"{what}_noise",
            meaning=f"standard deviation of the tracker's white noise in {what}",
            value=sd,
            unit=unit,
            follows="modelled",
            why="learned anew of each robot's rows",
        )
        yield PreflightEntry(
            name=f"{what}_noise_correlation",
            meaning=f"of the noise in {what} with that one pose later: 0 white, "
            "2/3 an average over three poses or every second one interpolated",
            value=None if own is None else own.value,
            low=None if own is None else own.low,
            high=None if own is None else own.high,
            unit="1",
            why="commands never hold for long enough to see" if own is None else "",
        )
        yield PreflightEntry(
            name=f"{what}_step",
            meaning=f"step in which {what}s come",
            value=step,
            unit=unit,
            follows="nothing" if step is None else "modelled",
            why="they come in none" if step is None else "counted in the noise",
        )


def _of_frame(log: MeasuredLog, model: ModelFile, noise: PoseNoise) -> Iterator[PreflightEntry]:
    arena = model.arena
    reach = None if arena is None else arena.radius - model.robot.body_radius
    found = failures(log, noise, reach)
    yield _repaired(
        "outliers", "share of poses far from their neighbours", found.outliers, "they are set aside"
    )
    if found.beyond is not None:
        yield _repaired(
            "beyond_wall",
            "share of poses further out than the believed wall lets a robot be",
            found.beyond,
            "they count as contact and are in no window of motion",
        )
    yield PreflightEntry(
        name="furthest_pose",
        meaning="from the middle" + ("" if reach is None else f"; the wall lets {reach:g} m"),
        value=found.furthest,
        unit="m",
    )
    faced = facing(log, noise, model.nominal_drive)
    unseen = "robots hardly move" if faced is None else ""
    yield PreflightEntry(
        name="yaw_off_motion",
        meaning="share of moves that are not within an eighth of a turn of the yaw",
        value=None if faced is None else faced.apart,
        unit="1",
        why=unseen,
    )
    yield PreflightEntry(
        name="motion_from_yaw",
        meaning="mean direction of motion less yaw",
        value=None if faced is None else faced.offset,
        unit="rad",
        why=unseen,
    )
    yield PreflightEntry(
        name="yaw_like",
        meaning="what fits the motion best: yaw, clockwise, degrees or quaternion z",
        value=None if faced is None else faced.like,
        why=unseen,
    )


def _of_recording(recording: Sequence[Value], alike: bool, known: bool) -> Iterator[PreflightEntry]:
    found = {value.name: value for value in recording}
    unasked = "as the reference's logs" if alike else "no fit" if known else "no healthy reference"
    doubted = sorted(c.name for c in causes().values() if c.family == TRANSIENT)
    for name, (unit, meaning) in RECORDING.items():
        entry = PreflightEntry(name=f"recording_{name}", meaning=meaning, value=None, unit=unit)
        value = found.get(name)
        if value is None:
            yield replace(entry, why=f"not fitted: {unasked}")
            continue
        yield replace(
            entry,
            value=value.value,
            low=value.low,
            high=value.high,
            follows="modelled",
            why="of all robots alike; of the whole swarm only more than this may feign is named",
            causes=tuple(doubted) if name in ("delay", "smear", "lag") else (),
        )


def _of_reference(log: MeasuredLog, reference: Reference, alike: bool) -> Iterator[PreflightEntry]:
    made = {
        "robots": ("healthy robots that it was made from", float(reference.robots), "1"),
        "swarms": ("runs that it was made from", float(reference.swarms), "1"),
        "step": ("between its logs' rows", reference.step or None, "s"),
        "recorder": ("what recorded its logs", reference.recorder or None, ""),
    }
    why = "" if reference.robots else "no healthy reference: what every robot does is like a fault"
    for name, (meaning, value, unit) in made.items():
        yield PreflightEntry(
            name=f"reference_{name}", meaning=meaning, value=value, unit=unit, why=why
        )
    modelled = bool(reference.robots) and not alike
    yield PreflightEntry(
        name="recorded_like_reference",
        meaning="whether recorder and step are those of the reference; "
        f"of this log {log.recorder or 'unknown'} and {log.step:g} s",
        value=alike,
        follows="modelled" if modelled else "nothing",
        why="how the log was recorded is fitted to all robots together" if modelled else "",
    )


def _columns(log: MeasuredLog) -> Iterator[PreflightEntry]:
    there = [name for name in log.frame.columns if log.frame[name].notna().any()]
    sensed = sense_causes().values()
    apart = [c for c in causes().values() if c.twins and c.separated_by]
    twins = {name for c in apart for name in (c.name, *c.twins)}
    either = "twins are told as either of the two; infrared or light tell clocks from latency"
    told = ("yaw",) if log.headed else ()
    needs = {
        "yaw": (told, HEADINGS, "taken from where robots go; not checked"),
        "encoders": (ENCODERS, twins, either),
        "infrared": (PS, {c.name for c in sensed if c.columns[0] in PS}, "not checked"),
        "light": (LS, {c.name for c in sensed if c.columns[0] in LS}, "not checked"),
        "nest": (("nest",), {c.name for c in sensed if c.columns[0] == "nest"}, "not checked"),
    }
    for name, (columns, silenced, why) in needs.items():
        yield _present(name, set(columns) & set(there), silenced, why)


def _present(
    name: str, there: Collection[str], silenced: Collection[str], why: str
) -> PreflightEntry:
    """Whether some columns are there, and what cannot be told where they are not."""
    meaning = f"whether the log has {name}"
    if there:
        return PreflightEntry(name=name, meaning=meaning, value=True)
    return PreflightEntry(
        name=name,
        meaning=meaning,
        value=False,
        follows="silences",
        why=why,
        causes=tuple(sorted(silenced)),
    )
