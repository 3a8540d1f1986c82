"""The study's results in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from realitygap.studies.transfer.alterations import Alteration

NOTHING = "nothing"


def diagnosed(diagnosis: Mapping[str, Any] | None) -> str:
    """What a diagnosis named, in words; or that the model was given."""
    if diagnosis is None:
        return "a given model"
    causes = [
        f"{cause['name']} "
        + ", ".join(f"{k} {_short(v['value'])}" for k, v in cause["parameters"].items())
        + ("" if cause["robots"] == "all" else f" (robots {cause['robots']})")
        for cause in diagnosis["causes"]
    ]
    return f"{diagnosis['verdict']}: " + ("; ".join(c.strip() for c in causes) or NOTHING)


def _short(value: float | str) -> str:
    """A number to three digits, or a word, as which sensor."""
    return value if isinstance(value, str) else f"{value:.3g}"


def food_line(one: Alteration, row: Mapping[str, Any] | None) -> str:
    """Food of the extended against the minimal model."""
    if row is None or not row["pairs"]:
        return f"{one.label}: no pair of runs is finished."
    numbers = (
        f"{row['mean_second']:.2f} items per minute with the minimal model, "
        f"{row['mean_first']:.2f} with the extended one"
    )
    if not row["verdict"]:
        return f"{one.label}: {numbers}; too few runs for an interval."
    said = {"more": "more", "less": "less", "not shown": "no difference shown"}[row["verdict"]]
    return (
        f"{one.label}: {numbers}; difference {row['difference']:+.2f} "
        f"({row['low']:+.2f} to {row['high']:+.2f}, {row['pairs']} pairs): {said}."
    )


def reason(picks: Sequence[Mapping[str, Any]]) -> str:
    """Why the extended model's food may equal the minimal one's: what each picks among nine."""
    by = {(p["model"], p["scenario"]): p for p in picks}
    scenarios = list(dict.fromkeys(p["scenario"] for p in picks))
    right = next(p["scenario"] for p in picks if p["right"])
    minimal, extended = by["minimal", right], by["extended", right]
    if all(by["minimal", s]["pick"] == by["extended", s]["pick"] for s in scenarios):
        return (
            "Both models pick the same of the nine controllers whatever S0 says "
            f"({extended['pick']} with the right one): a better model has nothing better to choose."
        )
    if minimal["pick"] == extended["pick"]:
        return (
            f"With the right S0 both models pick {extended['pick']}; they differ only where S0 is "
            "wrong."
        )
    told = (
        f"With the right S0 the minimal model picks {minimal['pick']} ({minimal['true']:.0f} s in "
        f"the altered world), the extended one {extended['pick']} ({extended['true']:.0f} s)."
    )
    around = [
        s for s in scenarios if s != right and by["minimal", s]["true"] >= extended["true"] - 2.0
    ]
    if around:
        told += (
            f" The minimal model finds as good a one by a wrong S0 ({', '.join(around)}): the "
            "swarm's environment gene makes up for what the model lacks."
        )
    return told


def outcome(content: Mapping[str, Any]) -> str:
    """What a study found, in one line, from the content of `transfer.json`."""
    verdicts = [
        row["verdict"]
        for entry in content["alterations"]
        for row in entry["comparisons"]
        if (row["metric"], row["first"], row["second"]) == ("food", "extended", "minimal")
    ]
    return (
        f"Of {len(content['alterations'])} altered realities the extended model brings more food "
        f"than the minimal one in {verdicts.count('more')}, less in {verdicts.count('less')} "
        "(95 % bootstrap intervals of paired differences)."
    )


def find(table: pd.DataFrame, alteration: str, metric: str) -> Mapping[str, Any] | None:
    """The row that compares the extended with the minimal model."""
    if table.empty:
        return None
    rows = table[
        (table["alteration"] == alteration)
        & (table["metric"] == metric)
        & (table["first"] == "extended")
        & (table["second"] == "minimal")
    ]
    return None if rows.empty else dict(rows.iloc[0])
