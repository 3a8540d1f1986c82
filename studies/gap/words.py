"""The gap in words: at most ten lines, the largest departure first."""

from __future__ import annotations

import numpy as np

from realitygap.models.gap.flips import Means
from realitygap.models.gap.shares import Share, explained, telling
from realitygap.models.gap.whole import LEVEL, TOTAL_LEVEL, Gap
from realitygap.models.log.measured import MeasuredLog
from realitygap.studies.fitness_gap.generations import CoevolutionGap

MOST = 10
"""Lines."""
FACTOR = 1.3
"""Errors differ by place or state when their sizes differ by more than this. Our choice."""
ENOUGH = 20
"""Windows for a group's error size to count."""
SHOWN = ("step", "0.4 s", "1 s", "5 s", "20 s")
WORDS = {
    "along": "distance ahead",
    "across": "sideways position",
    "heading": "heading",
    "all": "nothing in particular (a constant offset)",
    "change": "changes of command",
    "near_wall": "contact with the wall",
    "near_robot": "nearness to another robot",
    "radius": "distance from the arena's centre",
    "sector": "place around the arena",
    "time": "time since the start",
    "food": "carrying food",
    "nest": "being at the nest",
    "wall_distance": "distance to the wall",
    "wall_bearing": "direction of the wall",
    "lamp_distance": "distance to the lamp",
    "lamp_bearing": "direction of the lamp",
    "speed": "commanded speed",
    "turn": "commanded turn",
    "speed_change": "change of commanded speed",
    "turn_change": "change of commanded turn",
}


UNITS = {
    "change": "rad/s",
    "radius": "m",
    "speed": "m/s",
    "speed_change": "m/s",
    "time": "s",
    "turn": "rad/s",
    "turn_change": "rad/s",
}
"""Of conditions whose groups are bare numbers, as in "0.1 to 0.2"."""


def group_text(condition: str, group: str) -> str:
    """A group of a condition, with its unit."""
    unit = UNITS.get(condition)
    return f"{group} {unit}" if unit and group[-1:].isdigit() else group


def summary(log: MeasuredLog, gap: Gap, coevolution: CoevolutionGap | None = None) -> list[str]:
    """What departs from the model, largest first in units of noise, then what else to know."""
    weighed = [*_motion_lines(gap), *_sensor_lines(gap), *_robot_lines(gap)]
    lines = [line for _, line in sorted(weighed, key=lambda pair: -pair[0])]
    if not gap.flagged:
        lines.insert(0, f"No channel departs from the model beyond noise (level {TOTAL_LEVEL:g}).")
    elif gap.larger() and not any(m.p <= LEVEL for _, _, m in gap.maps()):
        lines.insert(0, _larger_line(gap))
    tail = [_noise_line(gap)]
    if coevolution is not None:
        tail.insert(0, fitness_line(coevolution))
    if log.notes:
        tail.append("Repaired or left out: " + "; ".join(log.notes) + ".")
    if gap.silent:
        tail.append("Not judged: " + "; ".join(gap.silent) + ".")
    return lines[: MOST - len(tail)] + tail


def size(value: float, unit: str, *, signed: bool = False) -> str:
    """A number with its unit, as one says it."""
    if unit == "m":
        value, unit = 1000 * value, "mm"
    return f"{value:+.3g} {unit}" if signed else f"{value:.3g} {unit}"


def _motion_lines(gap: Gap) -> list[tuple[float, str]]:
    """Position and heading against horizon, and what each channel depends on most."""
    lines = []
    medians = gap.horizons.groupby("horizon", sort=False).median(numeric_only=True)
    for channel, unit, parts in (
        ("position", "m", ("along", "across")),
        ("heading", "rad", ("heading",)),
    ):
        column = medians[f"{channel}_median"]
        ratio = medians[f"{channel}_median"] / medians[f"{channel}_noise"]
        told = ", ".join(
            f"{size(float(column[h]), unit)} after {h.replace('step', 'a step')}"
            for h in SHOWN
            if h in medians.index
        )
        text = f"{channel.capitalize()} is off by {told} (medians)"
        weight = float(ratio.max())
        if (worst := _largest(gap, parts, unit)) is not None:
            text += f"; {worst}"
        lines.append((weight, text + "."))
        if (best := _strongest(gap, "motion", parts)) is not None:
            horizon, found, share = best
            name = f"{WORDS[found.channel].capitalize()} over {horizon.replace('step', 'a step')} "
            share_of = share.bias + share.structured
            lines.append((weight * share_of, name + _depends(found, share, unit) + "."))
    return lines


def _sensor_lines(gap: Gap) -> list[tuple[float, str]]:
    """One line per kind of sensor that departs from its prediction."""
    lines = []
    for sensor in gap.sensors:
        name = {"ps": "Infrared", "ls": "Light"}[sensor.kind]
        best = _strongest(gap, sensor.kind, sensor.channels)
        if best is None:
            lines.append((0.0, f"{name} sensors read what the model predicts, up to noise."))
            continue
        _, found, share = best
        flagged = {m.channel for m in sensor.maps if m.p <= LEVEL}
        who = f"all {len(flagged)} sensors" if len(flagged) == len(sensor.channels) else None
        who = who or ", ".join(c for c in sensor.channels if c in flagged)
        weight = max(np.sqrt(1.0 / max(s.noise, 1e-6)) for s in sensor.shares.values())
        text = f"{name} departs in {who}; most in {found.channel}, which "
        lines.append((float(weight), text + _depends(found, share, "counts") + "."))
    return lines


def _robot_lines(gap: Gap) -> list[tuple[float, str]]:
    """One line per robot unlike the others."""
    unit = {"along": "m", "across": "m", "heading": "rad"}
    noise = {g.horizon: g.shares for g in gap.motion}.get("1 s", {})
    lines = []
    for odd in gap.robots:
        if odd.p <= LEVEL:
            off = size(odd.deviation, unit[odd.channel])
            where = (
                ""
                if odd.condition == "all"
                else f" at {WORDS[odd.condition]} {group_text(odd.condition, odd.group)}"
            )
            text = f"{odd.robot} is unlike the others: its {WORDS[odd.channel]} over 1 s differs by"
            floor = noise[odd.channel].noise_rms if odd.channel in noise else abs(odd.deviation)
            lines.append((10.0 + abs(odd.deviation) / floor, f"{text} {off}{where}."))
    return [(weight, line[0].upper() + line[1:]) for weight, line in lines]


def ranked_maps(maps: list[Means], rms: float) -> list[Means]:
    """Maps by what they explain of their channel's error, the most telling first."""
    return sorted(maps, key=lambda m: (-explained(m, rms), -float(np.abs(m.z).max(initial=0.0))))


def _strongest(gap: Gap, kind: str, channels: tuple[str, ...]) -> tuple[str, Means, Share] | None:
    """The flagged map of some channels that explains most, with its horizon and share."""
    shares = {(k, h, c): share for k, h, c, share in gap.shares()}
    found = [
        (h, m, shares[k, h, m.channel])
        for k, h, m in gap.maps()
        if k == kind and m.channel in channels and m.p <= LEVEL
    ]
    return max(found, key=lambda item: explained(item[1], item[2].rms), default=None)


def _largest(gap: Gap, channels: tuple[str, ...], unit: str) -> str | None:
    """Where errors are largest over the horizon shown, if they differ by a factor."""
    for motion in gap.motion:
        if motion.horizon == "1 s":
            break
    else:
        return None
    told, most = None, FACTOR
    for found in motion.maps:
        enough = found.number >= max(ENOUGH, 0.02 * found.number.sum())
        if found.channel not in channels or enough.sum() < 2 or found.condition == "robot":
            continue
        rms = np.where(enough, found.rms, np.nan)
        high, low = int(np.nanargmax(rms)), int(np.nanargmin(rms))
        if rms[low] > 0 and rms[high] / rms[low] > most:
            most = float(rms[high] / rms[low])
            what = WORDS.get(found.condition, found.condition)
            told = (
                f"over 1 s most by {what} ({size(rms[high], unit)} rms {WORDS[found.channel]} at "
                f"{group_text(found.condition, found.labels[high])}, {size(rms[low], unit)} at "
                f"{group_text(found.condition, found.labels[low])})"
            )
    return told


def _depends(found: Means, share: Share, unit: str) -> str:
    """What a map says."""
    at = telling(found)
    what = WORDS.get(found.condition, found.condition)
    group = (
        ""
        if found.condition == "all"
        else f", most at {group_text(found.condition, found.labels[at])}"
    )
    part = 100 * explained(found, share.rms)
    return (
        f"depends on {what}{group}: mean {size(found.mean[at], unit, signed=True)}"
        f" (explains {part:.0f} % of the mean square)"
    )


def _larger_line(gap: Gap) -> str:
    """Errors too large for noise whose mean depends on nothing that was mapped."""
    horizon, channel, found = max(gap.larger(), key=lambda item: item[2].ratio)
    return (
        f"Errors are larger than noise makes them, most {WORDS[channel]} over {horizon} "
        f"({found.ratio:.2g} times), though their mean depends on nothing mapped: look at delays, "
        "slow motors and contact."
    )


def _noise_line(gap: Gap) -> str:
    """The tracker's noise."""
    position, heading = size(gap.noise.position, "m"), np.degrees(gap.noise.heading)
    return f"Tracker noise, from the log itself: {position} and {heading:.2g} deg."


def fitness_line(found: CoevolutionGap) -> str:
    """F_S - F_R and its two parts."""
    report = found.report
    parts = []
    for key, name in (("robot_model", "the robot's"), ("environment_model", "the environment's")):
        value = report[key]["value"]
        parts.append(f"{'unknown' if value is None else f'{value:+.3g} s'} from {name} model")
    share = 100 * report["share_right_third"]
    return (
        f"Simulated fitness exceeds reality by {report['total']['value']:+.3g} s on average: "
        f"{' and '.join(parts)} (S0 in the right third in {share:.0f} %)."
    )
