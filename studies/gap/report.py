"""The gap as numbers: what `gap.json` holds, and the tidy tables."""

from __future__ import annotations

from typing import Any, NamedTuple

import pandas as pd

from realitygap.models.gap.flips import Means
from realitygap.models.gap.motion_gap import UNITS
from realitygap.models.gap.shares import Share, explained
from realitygap.models.gap.whole import COLUMNS, LEVEL, TOTAL_LEVEL, Gap
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import pose_noise
from realitygap.studies.fitness_gap.generations import CoevolutionGap
from realitygap.studies.gap.words import ranked_maps, summary

SCHEMA = 1
MOST_CONDITIONS = 3
"""Conditions listed per channel in `gap.json`; `maps.parquet` has them all."""


def describe(
    log: MeasuredLog, gap: Gap, *, name: str, coevolution: CoevolutionGap | None = None
) -> dict[str, Any]:
    """What `gap.json` holds: plain numbers, text and lists."""
    report: dict[str, Any] = {
        "schema": SCHEMA,
        "model": {"name": name, "sensors": bool(gap.sensors)},
        "log": {
            "rows": len(log.t),
            "runs": int(log.segments["run"].nunique()),
            "robots": int(log.segments["robot"].nunique()),
            "seconds": float((log.t[log.start[1:] - 1] - log.t[log.start[:-1]]).sum()),
            "step_s": log.step,
            "notes": list(log.notes),
            "not_judged": list(gap.silent),
        },
        "noise": {
            "position_m": gap.noise.position,
            "heading_rad": gap.noise.heading,
            "how": " ".join((pose_noise.__doc__ or "").split(";")[0].split())
            + ", from second differences of one-step errors under steady commands",
        },
        "level": TOTAL_LEVEL,
        "flagged": gap.flagged,
        "horizons": _horizons(gap),
        "channels": _channels(gap),
        "robots": [odd._asdict() | {"flagged": odd.p <= LEVEL} for odd in gap.robots],
    }
    if coevolution is not None:
        report["coevolution"] = coevolution.report
    report["summary"] = summary(log, gap, coevolution)
    return report


def _horizons(gap: Gap) -> list[dict[str, Any]]:
    """Per horizon the median over robots and runs of each quantile."""
    rows = []
    for name, part in gap.horizons.groupby("horizon", sort=False):
        row: dict[str, Any] = {"horizon": name, "seconds": float(part["seconds"].median())}
        row["windows"] = int(part["windows"].sum())
        for channel, unit in COLUMNS.items():
            kinds = ("median", "p95", "noise")
            values = {kind: float(part[f"{channel}_{kind}"].median()) for kind in kinds}
            row[channel] = values | {"unit": unit}
        rows.append(row)
    return rows


def _channels(gap: Gap) -> list[dict[str, Any]]:
    """Every channel: how large its error is, its shares, and what it depends on most."""
    maps: dict[tuple[str, str, str], list[Means]] = {}
    for kind, horizon, found in gap.maps():
        maps.setdefault((kind, horizon, found.channel), []).append(found)
    larger = {(g.horizon, c): found for g in gap.motion for c, found in g.excess.items()}
    rows = []
    for kind, horizon, channel, share in gap.shares():
        excess = larger.get((horizon, channel))
        ranked = ranked_maps(maps.get((kind, horizon, channel), []), share.rms)
        rows.append(
            {
                "kind": kind,
                "channel": channel,
                "horizon": horizon or None,
                "unit": unit_of(channel),
                "rms": share.rms,
                "noise_rms": share.noise_rms,
                "bias_value": share.bias_value,
                "shares": {name: getattr(share, name) for name in ("noise", "bias", "structured")},
                "excess": None if excess is None else excess._asdict(),
                "p": min((m.p for m in ranked), default=1.0),
                "depends_on": [
                    _condition(m, share)
                    for m in [m for m in ranked if m.p <= LEVEL][:MOST_CONDITIONS]
                ],
            }
        )
    return rows


def _condition(found: Means, share: Share) -> dict[str, Any]:
    """One map in short: its groups' means."""
    groups = zip(found.labels, found.number, found.mean, found.rms, found.z, strict=True)
    return {
        "condition": found.condition,
        "p": found.p,
        "explains": explained(found, share.rms),
        "groups": [
            {
                "group": label,
                "windows": int(n),
                "mean": float(mean),
                "rms": float(rms),
                "z": float(z),
            }
            for label, n, mean, rms, z in groups
            if n
        ],
    }


def unit_of(channel: str) -> str:
    """m, rad or counts."""
    return UNITS.get(channel, "counts")


class Tidy(NamedTuple):
    """A table that is written as it is."""

    frame: pd.DataFrame
    units: dict[str, str]
    """Of columns that have one."""


def tidy_tables(log: MeasuredLog, gap: Gap) -> dict[str, Tidy]:
    """By name: errors by horizon, every map, every judged window, every sensor residual."""
    units = {"seconds": "s"}
    units |= {f"{c}_{q}": u for c, u in COLUMNS.items() for q in ("median", "p95", "noise")}
    horizons = gap.horizons.assign(robot=gap.horizons["robot"].map(log.names.key))
    tables = {"horizons": Tidy(horizons, units), "maps": Tidy(_map_table(gap), {})}
    parts = []
    for motion in gap.motion:
        frame = motion.table.assign(
            horizon=motion.horizon, t=log.t[motion.pairs.first], clear=motion.clear
        )
        frame["run"] = log.frame["run"].astype(str).to_numpy()[motion.pairs.first]
        frame["robot"] = log.robots[motion.pairs.first]
        wrong = zip(UNITS, motion.error.T, strict=True)
        parts.append(frame.assign(**{f"error_{name}": column for name, column in wrong}))
    if parts:
        named = {f"error_{name}": unit for name, unit in UNITS.items()}
        named |= {"t": "s", "time": "s", "speed": "m/s", "turn": "rad/s", "change": "rad/s"}
        named |= {"speed_change": "m/s", "turn_change": "rad/s"}
        named |= dict.fromkeys(("x", "y", "radius", "near_wall", "near_robot"), "m")
        named |= dict.fromkeys(("heading", "sector"), "rad")
        tables["windows"] = Tidy(pd.concat(parts, ignore_index=True), named)
    for sensor in gap.sensors:
        residual = pd.DataFrame(sensor.residual, columns=list(sensor.channels))
        there = sensor.table.drop(columns=["robot", "run"]).assign(clear=sensor.clear)
        counts = dict.fromkeys(sensor.channels, "counts")
        tables[sensor.kind] = Tidy(pd.concat([there, residual], axis=1), counts)
    return tables


def _map_table(gap: Gap) -> pd.DataFrame:
    """One row per kind, horizon, channel, condition and group."""
    parts = []
    for kind, horizon, found in gap.maps():
        columns = {
            "group": found.labels,
            "centre": found.centres,
            "windows": found.number,
            "mean": found.mean,
            "standard_error": found.error,
            "rms": found.rms,
            "z": found.z,
        }
        frame = pd.DataFrame(columns)
        frame.insert(0, "condition", found.condition)
        frame.insert(0, "channel", found.channel)
        frame.insert(0, "horizon", horizon)
        frame.insert(0, "kind", kind)
        parts.append(frame.assign(p=found.p, unit=unit_of(found.channel)))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()
