"""The battery's page: confusion matrix, detection limits, curves, and every figure as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from realitygap.studies.blind.directory import BlindDirectory
from realitygap.studies.blind.scoring import outcome
from realitygap.studies.blind.summary import ABSTAINED, Result, results
from realitygap.studies.blind.trials import BlindConfig
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.pages.page import PageTable, Picture, Section, write_page
from realitygap.studies.plumbing.output import whole_file

COLOURS = {"named": "#2a9d8f", "ambiguous": "#f2b134", "no name": "#9aa5b1", "wrong": "#b3261e"}


def write_report(directory: BlindDirectory[BlindConfig], summary: dict[str, Any]) -> None:
    """Draw the figures and write `report.html`."""
    figures = directory.out / "figures"
    figures.mkdir(exist_ok=True)
    done = results(directory)
    sns.set_theme(style="whitegrid", context="notebook", font_scale=0.85)
    sections = [Section("Errors", tables=[PageTable.of(_errors(summary))])]
    if any(summary["confusion"].values()):
        answered = Section(
            "What was hidden and what was answered",
            ["Single effects and healthy runs; every size counts. A row is what was hidden."],
            figures=[
                Picture(
                    _confusion(summary["confusion"], figures / "confusion.png"),
                    "Share of trials; numbers are trials.",
                )
            ],
        )
        sections.insert(0, answered)
    if summary["effects"]:
        sections += [
            Section(
                "From which size on an effect is named",
                [
                    "A limit is the size named in 95 % of trials with 120 s of log: a logistic "
                    "fit in log size and log length, its interval a parametric bootstrap. "
                    "Coverage is the share of 95 % intervals that hold the truth."
                ],
                figures=[
                    Picture(
                        _sizes(done, figures / "sizes.png"),
                        "Every trial with one effect, by its size in multiples of the bar.",
                    )
                ],
                tables=[PageTable.of(_effects(summary["effects"]))],
            ),
            _unknown("What no catalogue lists", summary["unlisted"]),
            _unknown("Effects taken out of the catalogue", summary["leave_one_out"]),
            Section("Two effects at once", tables=[PageTable.of(_pairs(summary["pairs"]))]),
        ]
    if summary["wrong_names"]["which"]:
        lines = pd.DataFrame(
            {"trial: name given for what was hidden": summary["wrong_names"]["which"]}
        )
        sections.append(Section("Every wrong name", tables=[PageTable.of(lines)]))
    with whole_file(directory.out / "report.html", force=True) as part:
        write_page(part, "The blind battery", _lead(summary), sections)


def _lead(summary: dict[str, Any]) -> str:
    """The result in a few sentences."""
    wrong, healthy = summary["wrong_names"], summary["healthy_robots_accused"]
    return (
        f"{summary['trials']} trials. {_percent(wrong)} of the names given are wrong, "
        f"{_percent(healthy)} of the robots with nothing wrong are accused, and "
        f"{_percent(summary['coverage'])} of the intervals hold the truth."
    )


def _percent(found: dict[str, Any]) -> str:
    if found["share"] is None:
        return "(untried)"
    return (
        f"{100 * found['share']:.1f} % ({found['hits']} of {found['trials']}, "
        f"95 % interval {100 * found['low']:.1f}–{100 * found['high']:.1f} %)"
    )


def _errors(summary: dict[str, Any]) -> pd.DataFrame:
    healthy = summary["healthy_runs"]
    rows = {
        "healthy runs: robots accused": healthy["robots_accused"],
        "healthy runs: unexplained": healthy["unexplained"],
        "healthy runs: the log cannot tell": healthy["cannot_tell"],
        "all runs: robots with nothing wrong, accused": summary["healthy_robots_accused"],
        "wrong names among names given": summary["wrong_names"],
        "intervals that hold the truth": summary["coverage"],
        "pairs: exactly both named": summary["pairs"]["exact"],
    }
    return pd.DataFrame({"measure": rows.keys(), "share": [_percent(v) for v in rows.values()]})


def _effects(effects: dict[str, Any]) -> pd.DataFrame:
    rows = []
    for name, found in effects.items():
        rows.append(_effect_row(name, found, found["unit"]))
        if "whole_swarm" in found:
            rows.append(_effect_row(f"{name}, whole swarm", found["whole_swarm"], found["unit"]))
    return pd.DataFrame(rows)


def _effect_row(name: str, found: dict[str, Any], unit: str) -> dict[str, object]:
    limit = found["limit"]
    text = "–"
    if limit is not None:
        sign = {"above": "above sizes tried: ", "below": "below sizes tried: ", "": ""}
        text = (
            f"{sign[limit['beyond_sizes_tried']]}{limit['value']:.3g} "
            f"({limit['low']:.2g}–{limit['high']:.2g})"
        )
    return {
        "effect": name,
        "unit": unit,
        "bar": float(found["bar"]) or float("nan"),
        "limit, 95 % of trials": text,
        "named from the bar on": _ratio(found["named_from_bar_on"]),
        "named": _ratio(found["named"]),
        "ambiguous": _ratio(found["ambiguous"]),
        "wrong": _ratio(found["wrong"]),
        "coverage": _ratio(found["coverage"]),
    }


def _ratio(found: dict[str, Any]) -> str:
    return f"{found['hits']}/{found['trials']}"


def _unknown(title: str, found: dict[str, Any]) -> Section:
    text = (
        f"Flagged as unexplained: {_percent(found['flagged_unexplained'])}. "
        f"Only given a wrong name: {_percent(found['wrong_name_alone'])}. "
        f"Said to follow what it follows: {_percent(found['quantity_right'])}."
    )
    return Section(title, [text], tables=[PageTable.of(pd.DataFrame(found["answers"]))])


def _pairs(pairs: dict[str, Any]) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "pair": pairs["by_pair"].keys(),
            "exact": [_ratio(found) for found in pairs["by_pair"].values()],
        }
    )


def _confusion(rows: dict[str, dict[str, int]], path: Path) -> Path:
    names = [name for name in rows if name != "nothing"]
    given = {column for row in rows.values() for column in row}
    columns = [*[n for n in names if n in given], *sorted(given - {*names, *ABSTAINED})]
    columns += [name for name in ABSTAINED if name in given]
    counts = pd.DataFrame(rows).T.reindex(index=[*names, "nothing"], columns=columns).fillna(0.0)
    counts = counts[counts.sum(axis=1) > 0]
    height, width = 1.5 + 0.35 * len(counts), 4.0 + 0.5 * len(counts.columns)
    figure = Figure(figsize=(width, height), layout="constrained")
    sns.heatmap(
        counts.div(counts.sum(axis=1), axis=0),
        annot=counts.astype(int).astype(str).replace("0", ""),
        fmt="",
        cmap="Blues",
        vmin=0.0,
        vmax=1.0,
        cbar=False,
        linewidths=0.5,
        ax=figure.subplots(),
    )
    figure.axes[0].set(xlabel="answered", ylabel="hidden")
    figure.savefig(path, dpi=110, metadata={"Software": ""})
    return path


def _sizes(done: list[Result], path: Path) -> Path:
    """A dot per trial: effect against size, coloured by what came of it."""
    singles = [r for r in done if r.trial.kind == "single" and MENU[r.trial.hidden[0].name].bar]
    frame = pd.DataFrame(
        {
            "effect": [r.trial.hidden[0].name for r in singles],
            "multiple": [r.trial.hidden[0].multiple for r in singles],
            "answer": [_answer(r) for r in singles],
            "log": [f"{r.trial.seconds:.0f} s" for r in singles],
        }
    )
    order = [name for name in MENU if name in set(frame["effect"])]
    figure = Figure(figsize=(9.0, 1.2 + 0.35 * max(len(order), 1)), layout="constrained")
    axes = figure.subplots()
    if len(frame):
        frame["row"] = [order.index(name) for name in frame["effect"]]
        frame["row"] += np.tile([-0.2, 0.0, 0.2], len(frame))[: len(frame)]
        sns.scatterplot(
            frame, x="multiple", y="row", hue="answer", palette=COLOURS, style="log", ax=axes, s=45
        )
        sns.move_legend(axes, "center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        axes.set(xscale="log", yticks=range(len(order)), yticklabels=order)
        axes.set(xticks=(0.25, 0.5, 1, 2, 4), xticklabels=("1/4", "1/2", "1", "2", "4"))
        axes.minorticks_off()
        axes.invert_yaxis()
    axes.axvline(1.0, color="black", linewidth=1.0)
    axes.set(xlabel="size / bar", ylabel="")
    figure.savefig(path, dpi=110, metadata={"Software": ""})
    return path


def _answer(result: Result) -> str:
    if result.score.wrong:
        return "wrong"
    if result.score.right[0]:
        return "named"
    return "ambiguous" if outcome(result.trial, result.score) == "ambiguous" else "no name"
