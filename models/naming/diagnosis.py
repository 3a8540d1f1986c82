"""The diagnosis: verdict, causes, what stays unexplained, and `diagnosis.json`.

The verdict is one of five. `nothing_wrong`: nothing beyond what healthy robots show, in a log that
would have shown it. `cannot_tell`: nothing either, but of some robot the log would not have shown
even a large fault. `named`: causes that account for what was found. `ambiguous`: at least one cause
has a rival that the log cannot tell from it. `unexplained`: a difference from health remains that
no cause accounts for, or a cause was seen with which the model would predict worse.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from realitygap.models.belief.extension import Extension, NamedCause
from realitygap.models.log.named import Names
from realitygap.models.log.preflight.entry import PreflightEntry
from realitygap.models.log.used import Used
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.findings import Named
from realitygap.models.naming.laws.found import FoundLaw, law_as_json, law_table
from realitygap.models.naming.proposal.menu import Proposal
from realitygap.models.naming.rules import Rules

SCHEMA = 2
"""Of `diagnosis.json`. No rule."""
Verdict = Literal["named", "nothing_wrong", "cannot_tell", "unexplained", "ambiguous"]


@dataclass(frozen=True, kw_only=True)
class Unexplained:
    """Structure that no named cause accounts for."""

    channel: str
    share: float
    """Of the squared error, noise included, of the robots concerned."""
    where: str
    quantity: str = ""
    """The measured quantity that it follows (`motion.flexible.QUANTITIES`)."""
    robots: tuple[int, ...] | Literal["all"] = "all"
    distance: float = 0.0
    """Standard deviations from what healthy robots show."""


@dataclass(frozen=True, kw_only=True)
class Gain:
    """Mean absolute error of a prediction, on parts of the log that no value was fitted to."""

    before: float
    """By the model as it was."""
    after: float
    """By the extended model, read back from the text of its file."""
    low: float
    """Of `after`, 95 % by resampling blocks."""
    high: float
    healthy: float | None
    """What the minimal model is off of a healthy robot under the same commands; None: nobody knows
    what healthy robots do."""
    unit: str


@dataclass(frozen=True, kw_only=True)
class Detectable:
    """From which size on a cause would have been seen in this log."""

    cause: str
    parameter: str
    unit: str
    null: float | None
    """None: infinite."""
    size: float | None
    """Departure from the null; of an infinite one the value below which it would have been seen.
    None: it would not have been seen."""
    robot: int | None
    """In which it would have been seen worst; None: it belongs to the place."""


@dataclass(frozen=True, kw_only=True)
class Calibrated:
    """Values with which one robot is predicted best, and which are no diagnosis."""

    robot: int
    terms: tuple[NamedCause, ...]
    """Of the catalogue, all together; by itself none means what its name says."""
    errors: dict[str, tuple[float, float]]
    """By key of `gain`, mean error without and with them, on halves they were not fitted to."""


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """All that is said about one log."""

    named: tuple[Named, ...]
    unexplained: tuple[Unexplained, ...] = ()
    laws: tuple[FoundLaw, ...] = ()
    """Equations for what is unexplained."""
    calibration: tuple[Calibrated, ...] = ()
    """Of robots of which something stays open."""
    gain: dict[str, Gain] = field(default_factory=dict)
    detectable: tuple[Detectable, ...] = ()
    untold: Mapping[int, tuple[str, ...]] = field(default_factory=dict)
    """By robot that cannot be called sound, the causes that could be unseen in it."""
    used: tuple[Used, ...] = ()
    """How much of each robot's time could be used."""
    preflight: tuple[PreflightEntry, ...] = ()
    """What the log can tell."""
    not_checked: tuple[str, ...] = ()
    """What could not be looked at, and why, in words."""
    notes: tuple[str, ...] = ()
    """Repairs of the log."""
    robots: tuple[int, ...] = ()
    names: Names = field(default_factory=Names)
    """What robots are called, where the log has names."""
    rules: Rules = field(default_factory=Rules)
    """What naming was tuned to."""
    reference: str = ""
    """What health was taken from; empty: nothing."""
    proposal: Proposal | None = None
    """What to let the robots do next; None: nothing is ambiguous, or nothing would help."""

    @property
    def verdict(self) -> Verdict:
        """The verdict in one word."""
        if self.unexplained or not all(one.exported for one in self.named):
            return "unexplained"
        if any(alternatives(cause) for cause in self.named):
            return "ambiguous"
        if self.named:
            return "named"
        return "cannot_tell" if self.untold else "nothing_wrong"


def alternatives(named: Named) -> list[str]:
    """Other causes that could stand in a named one's place, nearest first."""
    names = [t.cause.name for t in (*named.twins, *named.evidence.rivals)]
    own = named.term.cause.name
    return list(dict.fromkeys(name for name in names if name != own))


def robots_of(named: Named, names: Names) -> list[int | str] | str:
    """Robots as `diagnosis.json` has them."""
    return "all" if named.whole_swarm else [names.key(robot) for robot in named.robots]


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
    names = found.names
    laws = [law_as_json(one, names) for one in found.laws]
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "causes": [_cause(one, names) for one in found.named],
        "unexplained": [
            {
                "channel": one.channel,
                "share": one.share,
                "where": one.where,
                "quantity": one.quantity,
                "robots": "all" if one.robots == "all" else [names.key(k) for k in one.robots],
                "distance": one.distance,
            }
            for one in found.unexplained
        ],
        **({"laws": laws} if laws else {}),
        "calibration": [_calibrated(one, names) for one in found.calibration],
        "next_experiment": next_experiment(found),
        "gain": {name: asdict(gain) for name, gain in found.gain.items()},
        "detectable": {one.cause: _detectable(one, names) for one in found.detectable},
        "log": {
            "robots": [one._asdict() | {"robot": names.key(one.robot)} for one in found.used],
            "cannot_tell": {names[robot]: list(unseen) for robot, unseen in found.untold.items()},
            "preflight": [asdict(one) | {"causes": list(one.causes)} for one in found.preflight],
        },
        "robots": [names.key(robot) for robot in found.robots],
        "reference": found.reference,
        "not_checked": list(found.not_checked),
        "notes": list(found.notes),
    }


def _cause(named: Named, names: Names) -> dict[str, Any]:
    cause = named.term.cause
    parameters: dict[str, dict[str, Any]] = {
        v.name: {"value": v.value, "low": v.low, "high": v.high, "unit": v.unit}
        for v in (*named.values, *named.given)
    }
    if cause.word:
        parameters[cause.word] = {"value": named.term.variant, "unit": "word"}
    return {
        "name": cause.name,
        "robots": robots_of(named, names),
        "parameters": parameters,
        "evidence": {
            "held_out_gain": named.evidence.share,
            "score": named.evidence.score,
            "deviance": named.evidence.gain,
            "distance": named.evidence.distance,
        },
        "alternatives": alternatives(named),
        "exported": named.exported,
        "why": named.why or None,
    }


def _calibrated(one: Calibrated, names: Names) -> dict[str, Any]:
    return {
        "robot": names.key(one.robot),
        "values": [
            {"name": term.name}
            | ({"word": term.word} if term.word else {})
            | {key: {"value": v.value, "unit": v.unit} for key, v in term.parameters.items()}
            for term in one.terms
        ],
        "errors": {key: {"before": b, "after": a} for key, (b, a) in one.errors.items()},
    }


def _detectable(one: Detectable, names: Names) -> dict[str, Any]:
    said = {name: value for name, value in asdict(one).items() if name != "cause"}
    return said | {"robot": None if one.robot is None else names.key(one.robot)}


def extension(found: Diagnosis, *, log_hash: str, command: str) -> Extension:
    """The causes and laws that are exported, as a model file's `[extension]`."""
    causes = (written(one, one.values) for one in found.named if one.exported)
    laws = (law_table(one) for one in found.laws if one.exported)
    known = {name: robot for robot, name in found.names.items()}
    calibrated = (
        term.model_copy(update={"robots": (one.robot,)})
        for one in found.calibration
        for term in one.terms
    )
    return Extension(
        log=log_hash,
        command=command,
        causes=tuple(causes),
        laws=tuple(laws),
        calibration=tuple(calibrated),
        names=known,
    )
