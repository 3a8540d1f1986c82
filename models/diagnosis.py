"""The diagnosis: verdict, causes, what stays unexplained, and `diagnosis.json`.

The verdict is one of four. `nothing_wrong`: nothing beyond what healthy robots show. `named`:
causes that account for what was found. `ambiguous`: at least one cause has a rival that the log
cannot tell from it. `unexplained`: a difference from health remains that no cause accounts for.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from models.extension import Extension, NamedCause, ParameterValue
from models.identify.swarm import Named
from models.opened import opened
from models.proposal.menu import Proposal
from models.table_files import MOST_BYTES

SCHEMA = 1
Verdict = Literal["named", "nothing_wrong", "unexplained", "ambiguous"]


@dataclass(frozen=True, kw_only=True)
class Unexplained:
    """Structure that no named cause accounts for."""

    channel: str
    share: float
    """Of the squared error, noise included, of the robots concerned."""
    where: str
    quantity: str = ""
    """The measured quantity that it follows (`models.identify.structure.QUANTITIES`)."""
    robots: tuple[int, ...] | Literal["all"] = "all"
    distance: float = 0.0
    """Standard deviations from what healthy robots show."""


@dataclass(frozen=True, kw_only=True)
class Gain:
    """Prediction error before and after, with a 95 % interval of the second."""

    before: float
    after: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """All that is said about one log."""

    named: tuple[Named, ...]
    unexplained: tuple[Unexplained, ...] = ()
    gain: dict[str, Gain] = field(default_factory=dict)
    not_checked: tuple[str, ...] = ()
    """What could not be looked at, and why, in words."""
    notes: tuple[str, ...] = ()
    """Repairs of the log."""
    robots: tuple[int, ...] = ()
    reference: str = ""
    """What health was taken from; empty: nothing."""
    proposal: Proposal | None = None
    """What to let the robots do next; None: nothing is ambiguous, or nothing would help."""

    @property
    def verdict(self) -> Verdict:
        """The verdict in one word."""
        if self.unexplained:
            return "unexplained"
        if any(alternatives(cause) for cause in self.named):
            return "ambiguous"
        return "named" if self.named else "nothing_wrong"


def alternatives(named: Named) -> list[str]:
    """Other causes that could stand in a named one's place, nearest first."""
    names = [t.cause.name for t in (*named.twins, *named.evidence.rivals)]
    own = named.term.cause.name
    return list(dict.fromkeys(name for name in names if name != own))


def robots_of(named: Named) -> list[int] | str:
    """Robots as `diagnosis.json` has them."""
    return "all" if named.whole_swarm else list(named.robots)


def next_experiment(found: Diagnosis) -> dict[str, Any] | None:
    """What to let the robots do next, as `diagnosis.json` has it."""
    proposal = found.proposal
    if proposal is None:
        return None
    return {
        "name": proposal.best.name,
        "separates": list(proposal.separates),
        "does": proposal.probe.does,
        "separation": proposal.best.separation,
        "lamp": "off" if proposal.probe.dark else "as it was",
        "needs": list(proposal.needs),
        "menu": [{"name": o.name, "separation": o.separation} for o in proposal.options],
    }


def as_json(found: Diagnosis) -> dict[str, Any]:
    """The content of `diagnosis.json`."""
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "causes": [_cause(one) for one in found.named],
        "unexplained": [
            {
                "channel": one.channel,
                "share": one.share,
                "where": one.where,
                "quantity": one.quantity,
                "robots": one.robots if one.robots == "all" else list(one.robots),
                "distance": one.distance,
            }
            for one in found.unexplained
        ],
        "next_experiment": next_experiment(found),
        "gain": {
            name: {
                "before": g.before,
                "after": g.after,
                "low": g.low,
                "high": g.high,
                "unit": g.unit,
            }
            for name, g in found.gain.items()
        },
        "robots": list(found.robots),
        "reference": found.reference,
        "not_checked": list(found.not_checked),
        "notes": list(found.notes),
    }


def _cause(named: Named) -> dict[str, Any]:
    cause = named.term.cause
    parameters: dict[str, dict[str, Any]] = {
        v.name: {"value": v.value, "low": v.low, "high": v.high, "unit": v.unit}
        for v in (*named.values, *named.given)
    }
    if cause.word:
        parameters[cause.word] = {"value": named.term.variant, "unit": "word"}
    return {
        "name": cause.name,
        "robots": robots_of(named),
        "parameters": parameters,
        "evidence": {
            "held_out_gain": named.evidence.share,
            "p_value": named.evidence.p_value,
            "deviance": named.evidence.gain,
            "distance": named.evidence.distance,
        },
        "alternatives": alternatives(named),
    }


def extension(found: Diagnosis, *, log_hash: str, command: str) -> Extension:
    """The named causes as a model file's `[extension]`."""
    return Extension(
        log=log_hash,
        command=command,
        causes=tuple(
            NamedCause(
                name=one.term.cause.name,
                robots="all" if one.whole_swarm else one.robots,
                word=one.term.variant,
                parameters={
                    v.name: ParameterValue(value=v.value, low=v.low, high=v.high, unit=v.unit)
                    for v in (*one.values, *one.given)
                },
            )
            for one in found.named
        ),
    )


def file_hash(paths: list[Path]) -> str:
    """SHA-256 over the content of log files, in order.

    Raises:
        InputError: as `models.opened.opened`.
    """
    digest = hashlib.sha256()
    for path in paths:
        with opened(path, "a measured log", most=MOST_BYTES) as file:
            while part := file.read(2**20):
                digest.update(part)
    return digest.hexdigest()
