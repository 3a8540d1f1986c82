"""The proposed manoeuvre for a reader: the commands that perform it, and the menu as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

from embedded_sim.probes import PREFIX
from models.log import MeasuredLog
from models.proposal.menu import ENOUGH, SECONDS, Proposal
from studies.diagnosis_request import Request
from studies.paper.page import Picture, Section, Table

MENU = (
    "How far apart the rivals' predictions are in every manoeuvre of the menu, in standard "
    "deviations of this log's noise, once the rival's numbers may move as far as the log leaves "
    "them open; two minutes, the nearest rival."
)


def commands(proposal: Proposal, request: Request, log: MeasuredLog) -> tuple[str, ...]:
    """What a user types: perform the manoeuvre, then diagnose it together with the logs.

    In the pybullet world; in a lab the robots are driven by the schedule of `embedded_sim.probes`.
    """
    cases = log.frame["case"].dropna() if "case" in log.frame else pd.Series(dtype=object)
    case = "no-light" if proposal.probe.dark else None if cases.empty else cases.mode().iloc[0]
    name = proposal.probe.name
    perform = ["realitygap run", f"--controller {PREFIX}{name}", f"--minutes {SECONDS / 60:g}"]
    perform += [f"--robots {log.frame['robot'].nunique()}"]
    perform += [f"--case {case}"] if case else []
    perform += [f"--out out/{name}"]
    together = ["realitygap diagnose", *(str(path) for path in request.logs), f"out/{name}"]
    together += [f"--model {request.model}"] if request.model else []
    together += [f"--reference {request.reference}"] if request.reference else []
    together += [f"--out out/{name}-diagnosis"]
    return " ".join(perform), " ".join(together)


def next_section(proposal: Proposal | None, following: Sequence[str], room: Path) -> list[Section]:
    """The report's section; nothing where nothing is proposed."""
    if proposal is None:
        return []
    rivals = " and ".join(proposal.separates)
    texts = [
        f"To tell {rivals} apart, let the robots do {proposal.best.name}: {proposal.probe.does}."
    ]
    if proposal.needs:
        texts.append(f"Log {' and '.join(proposal.needs)}: the poses say the same of both.")
    texts += list(following)
    _draw(proposal, room / "menu.png")
    table = pd.DataFrame(
        [{"manoeuvre": o.name, "separation (s.d.)": o.separation} for o in proposal.options]
    )
    return [
        Section(
            "What to do next",
            texts,
            figures=[Picture(room / "menu.png", MENU)],
            tables=[Table.of(table)],
        )
    ]


def _draw(proposal: Proposal, path: Path) -> None:
    figure = Figure(figsize=(10, 3.2), layout="constrained")
    axis = figure.subplots()
    names = [option.name for option in proposal.options]
    values = [max(option.separation, 1e-2) for option in proposal.options]
    sns.barplot(x=values, y=names, ax=axis, color="#4878a8")
    axis.axvline(ENOUGH, color="#222222", linewidth=1)
    axis.set(xscale="log", xlabel="separation (standard deviations)", ylabel="")
    figure.savefig(path, dpi=100)
