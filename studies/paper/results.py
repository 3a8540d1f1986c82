"""What came out, as sections made from a study's tables: on the page and in `results.md`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.studies.fitness_gap.generations import TRIALS
from realitygap.studies.pages.page import VERDICTS, PageTable, Section, number
from realitygap.studies.paper.claims import CLAIMS, PAPERS
from realitygap.studies.paper.conditions import LABELS, STUDIED, StudyConfig
from realitygap.studies.paper.mixture import evolved_text
from realitygap.studies.paper.our_claims import NUMBER, SELECTION
from realitygap.studies.paper.sequential import MOST_RUNS, WRONG, boundary, looks, shares
from realitygap.studies.paper.tables import TOUCH
from realitygap.studies.paper.verdicts import NOTES

WEIGHED = (
    "Each claim is an estimand, a range in which it is true, and a smallest difference that "
    "matters, written down before the runs. One rule decides: if the whole interval means no "
    "difference that matters, the claim is that; if it lies where the claim is true, it holds; if "
    "it lies where the claim is false, it does not hold; else it is open. Intervals are as wide as "
    "a group-sequential boundary asks for, so that runs may be added until a claim is decided, up "
    f"to {MOST_RUNS} of a condition. In a family of claims the chance of any wrong verdict is at "
    f"most {WRONG:.0%}."
)
OPEN_TEXT = (
    "Open means that these runs neither support nor contradict the claim: it is no evidence for "
    "the paper and none against it."
)


COMPANY_TEXT = (
    "Robots in the nest are a mean over the second half. Touching is the share of robots' seconds "
    f"with another one's centre within {100 * TOUCH:g} cm."
)
GAP_TEXT = (
    "All in seconds of fitness (eq. 1) per generation of 60 s. The first table gives the gap and "
    "its parts by case and by what the robot believed; the second what each of the nine "
    f"controllers earns in each simulated scenario, a mean of {TRIALS} fresh trials.",
)


def outcome(claims: pd.DataFrame) -> str:
    """How many of the paper's claims came out how."""
    papers = claims[claims["claim"].isin([claim.key for claim in PAPERS])]
    counts = papers["verdict"].value_counts()
    found = ", ".join(f"{counts.get(name, 0)} {name}" for name in VERDICTS)
    return f"Of {len(papers)} claims of the paper: {found}."


def result_sections(study: StudyConfig, folder: Path) -> list[Section]:
    """Food, claims, company and gap, from the tables that a study left in a folder.

    Args:
        study: What was run.
        folder: With `study.parquet`, `claims.csv`, `evolved.csv`, `gap.csv`, `controllers.csv`.
    """
    runs = pd.read_parquet(folder / "study.parquet")
    runs = runs[runs["variant"] == "default"]
    claims, evolved, gap, controllers = (
        pd.read_csv(folder / f"{name}.csv") for name in ("claims", "evolved", "gap", "controllers")
    )
    company = runs.groupby("label", sort=False)[["food_total", "crowd_nest", "touching"]].mean()
    return [
        Section("Items brought to the nest", tables=[PageTable.of(_food_view(runs))]),
        _claims_section(study, claims),
        Section(
            "What evolves with light at the nest, and who is near whom",
            (evolved_text(evolved), COMPANY_TEXT),
            tables=[PageTable.of(_evolved_view(evolved)), PageTable.of(_company_view(company))],
        ),
        Section(
            "The reality gap",
            GAP_TEXT,
            tables=[PageTable.of(_gap_view(gap)), PageTable.of(controllers)],
        ),
    ]


def _claims_section(study: StudyConfig, claims: pd.DataFrame) -> Section:
    """How claims are weighed, and every claim."""
    bounds = boundary(shares(study.runs), WRONG / 10 / 2.0)
    reach = ", ".join(f"{z:.2f} at {n}" for n, z in zip(looks(study.runs), bounds, strict=True))
    texts = [
        outcome(claims),
        OPEN_TEXT,
        WEIGHED,
        "The boundary of a family of ten, in standard errors of many runs, by runs of a condition: "
        f"{reach}.",
        "What stands beside a claim:",
        *(f"{note.label}: {note.text}" for note in NOTES),
    ]
    return Section("Claims of section IV", texts, tables=[claims_view(claims)])


def claims_view(claims: pd.DataFrame) -> PageTable:
    """The claims as the page shows them."""
    why = {claim.key: claim.because for claim in (*CLAIMS, *SELECTION, *NUMBER)}
    view = claims[["claim", "family", "text", "estimand"]].copy()
    view["estimate (interval)"] = [
        "–" if np.isnan(effect) else f"{number(effect)} ({number(low)} to {number(high)})"
        for effect, low, high in zip(claims["effect"], claims["low"], claims["high"], strict=True)
    ]
    for name in ("claimed", "alike"):
        ends = zip(claims[f"{name}_above"], claims[f"{name}_below"], strict=True)
        view[name] = [_range(*pair) for pair in ends]
    view["because"] = [why[key] for key in claims["claim"]]
    view["runs"] = claims["runs"].map(str)
    view["verdict"] = claims["verdict"]
    view["beside it"] = claims["notes"].fillna("")
    return PageTable.of(view)


def _range(low: float, high: float) -> str:
    """A range, as text."""
    if np.isnan(low):
        return "–"
    if high == float("inf"):
        return f"> {number(low)}"
    return f"< {number(high)}" if low == float("-inf") else f"{number(low)} to {number(high)}"


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


def _company_view(company: pd.DataFrame) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "condition": company.index,
            "items per run": company["food_total"].to_numpy(),
            "robots in the nest": company["crowd_nest"].to_numpy(),
            "touching": [f"{share:.1%}" for share in company["touching"]],
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
