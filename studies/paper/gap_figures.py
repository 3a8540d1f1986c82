"""The reality gap while it co-evolves: tables and figures of its course and what it is made of."""

from __future__ import annotations

import itertools

import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from realitygap.embedded_sim import SCENARIOS
from realitygap.studies.fitness_gap.generations import PARTS
from realitygap.studies.paper.conditions import COEVOLVED, LABELS
from realitygap.studies.paper.figures import THIRD_NAMES, THIRDS
from realitygap.studies.paper.tables import BEHAVIOURS, Array

SIDES = {"fitness_sim": "in simulation, as promised", "fitness_real": "in reality, as earned"}
COLORS = {"fitness_sim": "#c8553d", "fitness_real": "#33658a"}
PART_NAMES = ("winner's curse", "wrong scenario", "model error, right scenario")
PART_COLORS = ("#c9ada7", "#f2b134", "#6d597a")


def course(gaps: pd.DataFrame) -> Figure:
    """Fitness in simulation and in reality, per generation and per third of S0, by case."""
    figure = Figure(figsize=(14, 6.6), layout="constrained")
    panels = figure.subplots(2, len(COEVOLVED), sharey="row")
    long = gaps.melt(
        id_vars=["condition", "index", "generation", "s0_third"],
        value_vars=list(SIDES),
        var_name="side",
        value_name="fitness",
    )
    for axes, lower, condition in zip(panels[0], panels[1], COEVOLVED, strict=True):
        rows = long[long["condition"] == condition.name]
        means = rows.groupby(["index", "generation", "side"])["fitness"].mean().reset_index()
        runs_in = means.groupby("generation")["index"].transform("nunique")
        means = means[runs_in == runs_in.max()]  # the last whole generation is a few robots' only
        if len(means):
            sns.lineplot(
                data=means, x="generation", y="fitness", hue="side", palette=COLORS, ax=axes,
                errorbar="sd", legend=False,
            )  # fmt: skip
        axes.set(title=LABELS[condition.name], xlabel="generation", ylabel="fitness (s)")
        runs = rows.groupby(["index", "s0_third", "side"])["fitness"].mean().reset_index()
        if len(runs):
            sns.barplot(
                data=runs, x="s0_third", y="fitness", hue="side", palette=COLORS, ax=lower,
                order=range(3), hue_order=list(SIDES), errorbar="sd", legend=False,
            )  # fmt: skip
        lower.set_xticks(range(3))
        lower.set_xticklabels([name.replace(" ", "\n", 1) for name in THIRD_NAMES])
        lower.set(xlabel="believed", ylabel="fitness (s)")
    handles = [Patch(color=COLORS[side], label=name) for side, name in SIDES.items()]
    figure.legend(handles=handles, loc="outside upper right", ncols=2)
    figure.suptitle("The reality gap while it co-evolves (mean and s.d. over runs)", x=0.3)
    return figure


def parts(gaps: pd.DataFrame) -> Figure:
    """The gap split into its three parts, per case and per third of S0."""
    figure = Figure(figsize=(12, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    names = [condition.name for condition in COEVOLVED]
    by_case = gaps.groupby("condition")[[*PARTS, "gap"]].mean().reindex(names)
    by_third = gaps.groupby("s0_third")[[*PARTS, "gap"]].mean().reindex(range(3))
    for axes, table in ((left, by_case), (right, by_third)):
        for offset, (part, color) in enumerate(zip(PARTS, PART_COLORS, strict=True)):
            at = [row + 0.26 * (offset - 1) for row in range(len(table))]
            axes.bar(at, table[part].fillna(0.0), 0.25, color=color)
        axes.scatter(range(len(table)), table["gap"], color="black", marker="_", s=900, zorder=3)
        axes.axhline(0.0, color="0.3", linewidth=0.8)
        axes.set_xticks(range(len(table)))
    left.set_xticklabels([LABELS[name].replace(" ", "\n", 1) for name in names])
    right.set_xticklabels([f"believes\n{name}" for name in THIRD_NAMES])
    for label, color in zip(right.get_xticklabels(), THIRDS, strict=True):
        label.set_bbox({"facecolor": color, "alpha": 0.3, "edgecolor": "none"})
    left.set_ylabel("s of fitness per generation")
    handles = [
        Patch(color=color, label=name) for color, name in zip(PART_COLORS, PART_NAMES, strict=True)
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    figure.suptitle("What the gap is made of (black: the whole gap, simulation less reality)")
    return figure


def controllers_table(fresh: Array) -> pd.DataFrame:
    """`controllers.csv`: what each of the nine controllers earns in each simulated scenario."""
    rows = [
        {
            "carrying_food": BEHAVIOURS[g0],
            "without_food": BEHAVIOURS[g1],
            **{name: round(float(fresh[g0, g1, at]), 2) for at, name in enumerate(SCENARIOS)},
        }
        for g0, g1 in itertools.product(range(3), range(3))
    ]
    return pd.DataFrame(rows)


def gap_table(gaps: pd.DataFrame) -> pd.DataFrame:
    """`gap.csv`: mean gap and parts by condition and by third of S0, runs weighing alike."""
    rows = []
    for thirds in (False, True):
        keys = ["variant", "condition", *(["s0_third"] if thirds else [])]
        runs = gaps.groupby([*keys, "index"], sort=False)
        means = runs[["fitness_sim", "fitness_real", "gap", *PARTS]].mean()
        table = means.groupby(level=keys, sort=False).mean().reset_index()
        table["generations"] = gaps.groupby(keys, sort=False).size().to_numpy()
        if not thirds:
            table["s0_third"] = pd.NA
        rows.append(table)
    table = pd.concat([part.astype({"s0_third": "Int8"}) for part in rows], ignore_index=True)
    table.insert(2, "believes", table.pop("s0_third").map(dict(enumerate(SCENARIOS))).fillna("any"))
    return table
