"""The proposed manoeuvre for a reader: the commands that perform it, and the menu as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import seaborn as sns

from realitygap.embedded_sim.probes import PREFIX
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.proposal.menu import SECONDS, Proposal
from realitygap.studies.diagnosis.request import Request
from realitygap.studies.pages.drawing import HALF, canvas, save
from realitygap.studies.pages.page import Picture, Section
from realitygap.studies.plumbing.typed import typed

MENU = (
    "How far apart the rivals' predictions are in every manoeuvre of the menu, in standard "
    "deviations of this log's noise, once the rival's numbers may move as far as the log leaves "
    "them open; two minutes, the nearest rival."
)


def commands(proposal: Proposal, request: Request, log: MeasuredLog) -> tuple[str, ...]:
    """What a user types: perform the manoeuvre, then diagnose it together with the logs.

    A robot with a model of its own is not in the pybullet world: it drives the manoeuvre itself.
    """
    name = proposal.probe.name
    if request.model.typed:
        return (_together(request, f"out/{name}.parquet", name),)
    cases = log.frame["case"].dropna() if "case" in log.frame else pd.Series(dtype=object)
    case = "no-light" if proposal.probe.dark else None if cases.empty else cases.mode().iloc[0]
    perform = ["realitygap", "run", "--controller", PREFIX + name, "--minutes", f"{SECONDS / 60:g}"]
    perform += ["--robots", str(log.frame["robot"].nunique())]
    perform += ["--case", case] if case else []
    return typed(*perform, "--out", f"out/{name}"), _together(request, f"out/{name}", name)


def _together(request: Request, log: str, name: str) -> str:
    """The command that diagnoses a further log with the others."""
    return typed(*request.words(log), "--out", f"out/{name}-diagnosis")


def next_section(
    proposal: Proposal | None, following: Sequence[str], room: Path, least: float
) -> list[Section]:
    """The report's section, with what a manoeuvre must promise; nothing where none is proposed."""
    if proposal is None:
        return []
    rivals = " and ".join(proposal.separates)
    texts = [
        f"To tell {rivals} apart, let the robots do {proposal.best.name}: {proposal.probe.does}."
    ]
    if proposal.needs:
        texts.append(f"Log {' and '.join(proposal.needs)}: the poses say the same of both.")
    if len(following) == 1:
        texts.append(
            "The robots drive it themselves, by the schedule of docs/next-experiment.md. Log it "
            "with the same kind of commands, and diagnose both together:"
        )
    _draw(proposal, room / "menu.png", least)
    menu = Picture(room / "menu.png", MENU, wide=False)
    return [Section("What to do next", texts, commands=following, figures=[menu])]


def _draw(proposal: Proposal, path: Path, least: float) -> None:
    figure = canvas(HALF, 3.4)
    axis = figure.subplots()
    names = [option.name for option in proposal.options]
    values = [max(option.separation, 1e-2) for option in proposal.options]
    sns.barplot(x=values, y=names, ax=axis, color="#4878a8")
    axis.axvline(least, color="#222222", linewidth=1)
    axis.set(xscale="log", xlabel="separation (standard deviations)", ylabel="")
    save(figure, path)
