"""A law that was found in a log, what speaks for it, and how `diagnosis.json` has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from realitygap.embedded_sim.laws import Atom, Channel, Quantity
from realitygap.models.belief.law_tables import LawAmplitude, LawAtom, WrittenLaw
from realitygap.models.belief.law_words import UNIT, equation
from realitygap.models.log.named import Names


class Amount(NamedTuple):
    """Of one robot, in the channel's unit."""

    value: float
    low: float
    """Of 95 %."""
    high: float


@dataclass(frozen=True, kw_only=True)
class FoundLaw:
    """One form for all its robots, and an amplitude for each."""

    channel: Channel
    of: Quantity
    """What it follows."""
    atoms: tuple[Atom, ...]
    """Of a shape that was not found its curve; none where it cannot be drawn over one quantity."""
    robots: tuple[int, ...]
    """That have it."""
    amounts: Mapping[int, Amount]
    """By robot; empty where there are no atoms."""
    shape: bool
    """Whether its shape was found."""
    whole_swarm: bool
    reading: str
    """What it may mean."""
    gain: float
    """Deviance that it takes off blocks that it was not fitted to, its best fold as the others, of
    at most four robots."""
    ceiling: float
    """The same of the best curve of any quantity."""
    decoy: float
    """The same, at most, of quantities that cannot be behind it."""
    compared: int
    """Other robots of the log that were asked for the same law."""
    instead: tuple[str, ...] = ()
    """Laws that the log cannot tell from it, as equations without an amplitude."""
    errors: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """By key of `claims.ahead.KEYS`, what its robots are off in the mean without and with it."""
    exported: bool = True
    """Whether the extended model holds it."""
    why: str = ""
    """Why not, where it does not."""


def law_as_json(law: FoundLaw, names: Names) -> dict[str, Any]:
    """One of `laws` in `diagnosis.json`."""
    unit = UNIT.get(law.channel, "1")
    atoms = law.atoms or (Atom(law.of, "curve"),)
    alone = next(iter(law.amounts.values())).value if len(law.amounts) == 1 else None
    return {
        "equation": equation(law.channel, atoms, alone),
        "latex": equation(law.channel, atoms, alone, latex=True),
        "reading": law.reading,
        "channel": law.channel,
        "of": law.of,
        "shape": law.shape,
        "atoms": [
            {"of": atom.of, "form": atom.form, "parameters": list(atom.parameters)}
            for atom in law.atoms
        ],
        "coefficients": [
            {"robot": names.key(robot), **amount._asdict(), "unit": unit}
            for robot, amount in law.amounts.items()
        ],
        "robots": "all" if law.whole_swarm else [names.key(robot) for robot in law.robots],
        "evidence": {
            "held_out_gain": law.gain,
            "best_curve": law.ceiling,
            "best_decoy": law.decoy,
            "compared_with": law.compared,
        },
        "instead": list(law.instead),
        "errors": {
            name: {"before": before, "after": after, "unit": _unit(name)}
            for name, (before, after) in law.errors.items()
        },
        "exported": law.exported,
        "why": law.why or None,
    }


def _unit(name: str) -> str:
    return "m" if name.startswith("position") else "rad"


def law_table(law: FoundLaw) -> WrittenLaw:
    """A law as an extension has it; of the whole swarm also for robots that were not there."""
    unit = UNIT.get(law.channel, "1")
    told = [
        LawAmplitude(robot=robot, value=one.value, low=one.low, high=one.high)
        for robot, one in law.amounts.items()
    ]
    if law.whole_swarm:
        mean = sum(one.value for one in law.amounts.values()) / len(law.amounts)
        told.append(LawAmplitude(value=mean))
    return WrittenLaw(
        channel=law.channel,
        robots="all" if law.whole_swarm else tuple(law.amounts),
        unit=unit,
        atoms=tuple(
            LawAtom(of=atom.of, form=atom.form, parameters=atom.parameters) for atom in law.atoms
        ),
        amplitudes=tuple(told),
    )
