"""The pages of `realitygap measure real`: one of all data sets with a figure, and one of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.diagnosis.result import DiagnosisResult
from realitygap.studies.measure.real import DataSet, data_folder, data_sets, measured
from realitygap.studies.pages.drawing import canvas, save, themed
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.progress import unseen

ERRORS = "errors.csv"
"""Columns: data, horizon, model, position (m), heading (rad), windows, low, high (m)."""
PICTURE = "errors.png"
INDEX = "index.md"


def real(
    out: Path,
    *,
    data: Path | None = None,
    only: tuple[str, ...] = (),
    force: bool = False,
    begin: Callable[[str], None] = unseen,
) -> pd.DataFrame:
    """Measure real robots' logs and write their pages.

    Args:
        out: Directory of the pages.
        data: Folder with `optiodom/` and `drive/`; None: what REALITYGAP_DATA names.
        only: Beginnings of the names of data sets; empty: all.
        force: Replace what is there.
        begin: Called with the name of each data set.

    Raises:
        InputError: there are no data, none of those asked for, or `out` cannot be written.
    """
    folder = data_folder(data)
    with whole_directory(out, force=force, holds=(ERRORS,)) as part:
        tables = []
        for one in data_sets(folder):
            if only and not one.name.startswith(only):
                continue
            begin(one.name)
            table, said = measured(one)
            (part / f"{one.name}.md").write_text(_page(one, table, said), encoding="utf-8")
            tables.append(table.assign(data=one.name, verdict=said.verdict))
        if not tables:
            raise InputError("--only", ", ".join(only), "beginnings of names of data sets there")
        every = pd.concat(tables, ignore_index=True)
        columns = ["data", "horizon", "model", "position", "heading", "windows", "low", "high"]
        every[columns].to_csv(part / ERRORS, index=False, float_format="%.6g")
        (part / INDEX).write_text(_index(every), encoding="utf-8")
        _draw(every, part / PICTURE)
    return every


def _cells(table: pd.DataFrame) -> list[str]:
    """Errors by model (rows) and horizon, as Markdown."""
    horizons = list(dict.fromkeys(table["horizon"]))
    heads = [f"position {h} (mm) | heading {h} (mrad)" for h in horizons]
    lines = [f"| model | {' | '.join(heads)} |", "|---" * (1 + 2 * len(horizons)) + "|"]
    for model, own in table.groupby("model", sort=False):
        by = own.set_index("horizon")
        cells = [
            f"{1e3 * by.loc[h, 'position']:.3g} | {1e3 * by.loc[h, 'heading']:.3g}"
            if h in by.index
            else "- | -"
            for h in horizons
        ]
        lines.append(f"| {model} | {' | '.join(cells)} |")
    return lines


def _page(data: DataSet, table: pd.DataFrame, said: DiagnosisResult) -> str:
    """One data set."""
    gained = table[table["model"] == "extended"].set_index("horizon")[["low", "high"]]
    sure = [
        f"- {horizon}: {1e3 * low:.3g} to {1e3 * high:.3g} mm"
        for horizon, (low, high) in zip(gained.index, gained.to_numpy().tolist(), strict=True)
    ]
    found = said.content
    causes = [_cause(one) for one in found["causes"]]
    left = [f"- {one['where']} ({100 * one['share']:.0f} %)" for one in found["unexplained"]]
    terms = [_term(v) for one in found["calibration"] for v in one["values"]]
    return "\n".join(
        [
            f"# {data.name}",
            "",
            f"Model `{data.model}`, no healthy reference. Verdict on the earlier half: "
            f"**{said.verdict}**.",
            "",
            *(["## Named", "", *causes, ""] if causes else []),
            *(["## Unexplained", "", *left, ""] if left else []),
            *(["## Calibrated beside it, which is no diagnosis", "", *terms, ""] if terms else []),
            "## Mean errors on the later half",
            "",
            *_cells(table),
            "",
            "By how much the extended model's position error is smaller than the minimal one's "
            "(95 %, runs resampled):",
            "",
            *sure,
            "",
        ]
    )


def _cause(one: Mapping[str, Any]) -> str:
    told = [
        f"{name} {v['value']:.4g} ({v['low']:.4g} to {v['high']:.4g}) {v['unit']}"
        if "low" in v
        else str(v["value"])
        for name, v in one["parameters"].items()
    ]
    return f"- `{one['name']}`: {', '.join(told)}" + (f"; {one['why']}" if one["why"] else "")


def _term(one: Mapping[str, Any]) -> str:
    told = [f"{k} {v['value']:.4g} {v['unit']}" for k, v in one.items() if isinstance(v, dict)]
    return f"- `{one['name']}`: {', '.join(told)}"


def _index(every: pd.DataFrame) -> str:
    """All data sets at 5 s, or at their longest horizon below it."""
    models = list(dict.fromkeys(every["model"]))
    lines = [
        "# Real robots",
        "",
        "Written by `realitygap measure real`. Values and models come from the earlier half of "
        "each log. Errors are those of the later half: mean distance from where the robot was "
        "measured, in mm.",
        "",
        f"| data | verdict | after | {' | '.join(models)} |",
        "|---" * (3 + len(models)) + "|",
    ]
    for name, own in every.groupby("data", sort=False):
        horizon = "5 s" if (own["horizon"] == "5 s").any() else own["horizon"].iloc[-1]
        by = own[own["horizon"] == horizon].set_index("model")["position"]
        cells = [f"{1e3 * by[m]:.3g}" if m in by.index else "-" for m in models]
        verdict = own["verdict"].iloc[0]
        lines.append(f"| [{name}]({name}.md) | {verdict} | {horizon} | {' | '.join(cells)} |")
    return "\n".join([*lines, "", f"![Errors by model]({PICTURE})", ""])


def _draw(every: pd.DataFrame, file: Path) -> None:
    """Position errors of all models over those of the minimal one."""
    import seaborn as sns

    base = every[every["model"] == "minimal"].set_index(["data", "horizon"])["position"]
    key = pd.MultiIndex.from_frame(every[["data", "horizon"]])
    shown = every.assign(ratio=every["position"].to_numpy() / base.reindex(key).to_numpy())
    shown = shown[shown["model"] != "minimal"]
    with themed():
        figure = canvas(9.0, 0.35 * shown["data"].nunique() + 1.5)
        axes = figure.subplots(1, shown["horizon"].nunique(), sharey=True, squeeze=False)[0]
        for ax, (horizon, own) in zip(axes, shown.groupby("horizon", sort=False), strict=True):
            sns.stripplot(own, y="data", x="ratio", hue="model", ax=ax, legend=ax is axes[0])
            ax.axvline(1.0, color="0.5", linewidth=0.8)
            ax.set(
                xscale="log", xlabel=f"error after {horizon} over the minimal model's", ylabel=""
            )
        save(figure, file)
