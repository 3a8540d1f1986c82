"""The proposed manoeuvre for a reader: the commands that perform it, and the menu as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.embedded_sim.probes import PREFIX
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.proposal.ground import ground
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
    case = "no-light" if proposal.probe.dark else _case(log)
    perform = ["realitygap", "run", "--controller", PREFIX + name, "--minutes", f"{SECONDS / 60:g}"]
    perform += ["--robots", str(log.frame["robot"].nunique())]
    perform += ["--case", case] if case else []
    return typed(*perform, "--out", f"out/{name}"), _together(request, f"out/{name}", name)


def plan(proposal: Proposal, model: ModelFile, log: MeasuredLog) -> dict[str, Any]:
    """What `realitygap experiment` needs: the log's rate (s), its room, and what is expected."""
    place, names = ground(model, log), sorted({int(robot) for robot in log.segments["robot"]})
    where = {"x": place.x, "y": place.y, "radius": place.radius, "walled": place.walled}
    keys = [f"{one.name}/{one.word}" if one.word else one.name for one in proposal.rivals]
    return {
        "step": place.step,
        "ground": where,
        "rivals": [
            {"name": one.name, "word": one.word or None, "values": dict(one.values)}
            for one in proposal.rivals
        ],
        "expected": [
            {
                "robot": None if one.robot is None else log.names.key(names[one.robot]),
                "t_start": one.begin,
                "t_end": one.end,
                "channel": one.channel,
                "unit": one.unit,
                "values": dict(zip(keys, one.values, strict=True)),
                "apart": one.apart,
            }
            for one in proposal.expected
        ],
    }


def _case(log: MeasuredLog) -> str | None:
    """Where the lamp mostly stood; None: the log does not tell."""
    cases = log.frame["case"].dropna() if "case" in log.frame else pd.Series(dtype=object)
    return None if cases.empty else str(cases.mode().iloc[0])


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
            "realitygap experiment writes it as commands for these robots. Log it with the same "
            "kind of commands, and diagnose both together:"
        )
    _draw(proposal, room / "menu.png", least)
    menu = Picture(room / "menu.png", MENU, wide=False)
    return [Section("What to do next", texts, commands=following, figures=[menu])]


def _draw(proposal: Proposal, path: Path, least: float) -> None:
    figure = canvas(HALF, 3.4)
    axis = figure.subplots()
    names = [option.name for option in proposal.options]
    values = [max(option.separation, 1e-2) for option in proposal.options]
    axis.barh(names, values, color="#4878a8")
    axis.invert_yaxis()
    axis.grid(visible=False, axis="y")
    axis.axvline(least, color="#222222", linewidth=1)
    axis.set(xscale="log", xlabel="separation (standard deviations)", ylabel="")
    save(figure, path)
