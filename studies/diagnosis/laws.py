"""The laws of a diagnosis on its page: equations, readings, amplitudes, curves without a law."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.embedded_sim.laws import Atom
from realitygap.models.belief.law_values import value
from realitygap.models.belief.law_words import SYMBOLS, equation, size_in_words
from realitygap.models.log.named import Names
from realitygap.models.naming.laws.found import FoundLaw
from realitygap.studies.diagnosis.figures import draw_curves
from realitygap.studies.pages.page import PageTable, Picture, Section

ABOUT = (
    "Where no listed cause explains what is seen, an equation is looked for that does: one form, "
    "an amplitude for each robot. It is stated if it takes error off blocks of the log that it was "
    "not fitted to, half as much again as any decoy does: quantities of another time or of another "
    "robot. What the log's other robots show as well is no law of one."
)
NO_OTHERS = (
    "No other robots of this log could be asked for the same law, so that a habit of healthy "
    "robots cannot be told from it."
)
CURVES = "What was seen where no shape was found: how the amplitude follows the quantity."
POINTS = 200


def law_section(laws: Sequence[FoundLaw], names: Names, room: Path) -> list[Section]:
    """The section; nothing where there are no laws."""
    if not laws:
        return []
    rows = [
        {
            "law": equation(one.channel, one.atoms or (Atom(one.of, "curve"),)),
            "robots": "all" if one.whole_swarm else ", ".join(names[k] for k in one.robots),
            "a (95 % interval)": "; ".join(
                f"robot {names[robot]}: {size_in_words(one.channel, *amount)}"
                for robot, amount in one.amounts.items()
            ),
            "it may mean": one.reading if one.shape else f"{one.reading}; shape not found",
            "could also be": "; ".join(one.instead) or None,
            "in extended.toml": "yes" if one.exported else one.why,
            "deviance taken off, held out": f"{one.gain:.0f}",
            "of the best curve": f"{one.ceiling:.0f}",
            "of the best decoy": f"{one.decoy:.0f}",
        }
        for one in laws
    ]
    words = "; ".join(f"{symbol} is {meaning}" for symbol, meaning in SYMBOLS.items())
    alone = [NO_OTHERS] if any(not one.compared for one in laws) else []
    curves = [one for one in laws if one.atoms and one.atoms[0].form == "curve"]
    drawn = []
    if curves:
        draw_curves([_points(one) for one in curves], room / "laws.png")
        drawn.append(Picture(room / "laws.png", CURVES))
    texts = [ABOUT, *alone, f"In equations {words}; [...] is 1 where it holds, else 0."]
    return [Section("Laws", texts, tables=[PageTable.of(pd.DataFrame(rows))], figures=drawn)]


def _points(law: FoundLaw) -> tuple[str, str, np.ndarray, np.ndarray]:
    atom = law.atoms[0]
    at = np.linspace(atom.parameters[0], atom.parameters[1] - 1e-9, POINTS)
    size = max((one.value for one in law.amounts.values()), key=abs)
    return law.channel, atom.of, at, size * value(atom, {atom.of: at})
