"""Laws as `diagnosis.json` has them."""

from __future__ import annotations

from typing import Any

from realitygap.embedded_sim.laws import Atom
from realitygap.models.belief.law_tables import LawAmplitude, LawAtom, WrittenLaw
from realitygap.models.belief.law_words import UNIT, equation
from realitygap.models.log.named import Names
from realitygap.models.naming.laws.found import FoundLaw


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
