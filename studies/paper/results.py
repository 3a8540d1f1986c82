"""What came out, as sections made from a study's tables: on the page and in `results.md`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from realitygap.studies.fitness_gap.anew import TRIALS
from realitygap.studies.pages.page import VERDICTS, PageTable, Section, number
from realitygap.studies.paper.conditions import LABELS, STUDIED, StudyConfig
from realitygap.studies.paper.mixture import mixture_text
from realitygap.studies.paper.notes import NOTES
from realitygap.studies.paper.power import power_table, power_text

WEIGHED = (
    "Each claim is a statistic decided before any result was seen. Every value is one run. Effects "
    "carry 95 % bootstrap intervals. One rule decides in both directions. Reproduced: the estimate "
    "lies where the claim is true, and p for it is below the bar. Not reproduced: the estimate "
    "lies where it is false, and p against it, of the same test turned round, is below the same "
    "bar."
)
UNDECIDED = (
    "Undecided means that these runs neither support nor contradict the claim clearly enough for a "
    "table of so many claims. It is no evidence for the paper and none against it, and more runs "
    "may decide it either way."
)


GAP_TEXT = (
    "All in seconds of fitness (eq. 1) per generation of 60 s. The first table gives the gap and "
    "its parts by case and by what the robot believed; the second what each of the nine "
    f"controllers earns in each simulated scenario, a mean of {TRIALS} fresh trials.",
)


def outcome(claims: pd.DataFrame) -> str:
    """How many claims came out how, and where the undecided ones point."""
    counts = claims["verdict"].value_counts()
    found = ", ".join(f"{counts.get(name, 0)} {name}" for name in VERDICTS)
    astray = _astray(claims)
    return f"Of {len(claims)} claims: {found} ({len(astray)} of these point against the paper)."


def result_sections(study: StudyConfig, folder: Path) -> list[Section]:
    """Food, claims, mixture and gap, from the tables that a study left in a folder.

    Args:
        study: What was run.
        folder: With `study.parquet`, `claims.csv`, `mixture.csv`, `evolved.csv`, `gap.csv` and
            `controllers.csv`.
    """
    runs = pd.read_parquet(folder / "study.parquet")
    names = ("claims", "mixture", "evolved", "gap", "controllers")
    claims, mixture, evolved, gap, controllers = (
        pd.read_csv(folder / f"{name}.csv") for name in names
    )
    return [
        Section("Items brought to the nest", tables=[PageTable.of(_food_view(runs))]),
        _claims_section(study, claims),
        Section(
            "Why co-evolution collects more than the fixed positive controller",
            mixture_text(mixture, evolved),
            tables=[PageTable.of(_mixture_view(mixture)), PageTable.of(_evolved_view(evolved))],
        ),
        Section(
            "The reality gap",
            GAP_TEXT,
            tables=[PageTable.of(_gap_view(gap)), PageTable.of(controllers)],
        ),
    ]


def _claims_section(study: StudyConfig, claims: pd.DataFrame) -> Section:
    """How claims are weighed, what so many runs can decide, and every claim."""
    astray = ", ".join(_astray(claims)) or "none"
    texts = [
        outcome(claims),
        UNDECIDED,
        f"Undecided with an estimate against the paper: {astray}.",
        WEIGHED,
        power_text(study.runs, len(claims)),
        "What stands beside a claim:",
        *(f"{note.label}: {note.text}" for note in NOTES),
    ]
    tables = [PageTable.of(power_table(study.runs, len(claims))), claims_view(claims)]
    return Section("Claims of section IV", texts, tables=tables)


def claims_view(claims: pd.DataFrame) -> PageTable:
    """The claims as the page shows them."""
    view = claims[["claim", "text", "statistic"]].copy()
    view["effect (95 %)"] = [
        f"{number(effect)} ({number(low)} to {number(high)})"
        for effect, low, high in zip(claims["effect"], claims["low"], claims["high"], strict=True)
    ]
    view["claimed"] = [
        claimed(low, high)
        for low, high in zip(claims["claimed_above"], claims["claimed_below"], strict=True)
    ]
    view["points"] = [where or "–" for where in claims["points"].fillna("")]
    view["p for"] = [number(value) for value in claims["p"]]
    view["p against"] = [number(value) for value in claims["p_against"]]
    view["verdict"] = claims["verdict"]
    view["beside it"] = claims["notes"].fillna("")
    return PageTable.of(view)


def claimed(low: float, high: float) -> str:
    """The range in which a claim holds, as text."""
    if high == float("inf"):
        return f"> {number(low)}"
    return f"< {number(high)}" if low == float("-inf") else f"{number(low)} to {number(high)}"


def _astray(claims: pd.DataFrame) -> Sequence[str]:
    """Undecided claims whose estimate points against the paper."""
    which = (claims["verdict"] == "undecided") & (claims["points"] == "against")
    return claims.loc[which, "claim"].tolist()


def _food_view(runs: pd.DataFrame) -> pd.DataFrame:
    """Items per run by condition: mean, least, most, and the mean of each half."""
    food = runs.groupby("condition")["food_total"].agg(["count", "mean", "min", "max"])
    halves = runs.groupby("condition")[["food_first", "food_second"]].mean()
    table = food.join(halves).reindex([condition.name for condition in STUDIED]).reset_index()
    return pd.DataFrame(
        {
            "condition": table["condition"].map(LABELS),
            "runs": table["count"].fillna(0).astype(int),
            "items per run": table["mean"],
            "least": table["min"].astype(float),
            "most": table["max"].astype(float),
            "first half": table["food_first"],
            "second half": table["food_second"],
        }
    )


def _gap_view(table: pd.DataFrame) -> pd.DataFrame:
    view = table.drop(columns=["variant"]).rename(
        columns={
            "fitness_sim": "in simulation",
            "fitness_real": "in reality",
            "curse": "winner's curse",
            "scenario": "wrong scenario",
            "model": "model error",
        }
    )
    return view.astype({"generations": object})


def _mixture_view(mixture: pd.DataFrame) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "first": mixture["first"].map(LABELS),
            "second": mixture["second"].map(LABELS),
            "items of the first": mixture["food_first"].map(number),
            "of the second": mixture["food_second"].map(number),
            "difference (95 %)": [
                f"{number(row['difference'])} ({number(row['low'])} to {number(row['high'])})"
                for row in mixture.to_dict("records")
            ],
            "p, two-sided": mixture["p"].map(number),
            "paired": mixture["paired"].map({True: "yes", False: "no"}),
        }
    )


def _evolved_view(evolved: pd.DataFrame) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "carrying food": evolved["carrying_food"],
            "without food": evolved["without_food"],
            "share of controllers": evolved["share"].map("{:.1%}".format),
            "items per generation": evolved["items"].map(number),
        }
    )
