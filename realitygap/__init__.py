"""Measure the reality gap of a robot swarm's simulator: show it, name its cause, close it.

    import realitygap as rg

    log = rg.read_log("log.parquet", model="robot.toml")
    found = rg.diagnose(log)
    found.causes, found.extended

The command line calls these functions and nothing else. Units are SI, axes REP-103.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from realitygap.embedded_sim.errors import Diverged as Diverged
    from realitygap.embedded_sim.errors import InputError as InputError
    from realitygap.models.belief.new_model import new_model as new_model
    from realitygap.models.naming.rules import Rules as Rules
    from realitygap.studies import study as study
    from realitygap.studies.blind.battery import blind as blind
    from realitygap.studies.demo.demo import demo as demo
    from realitygap.studies.diagnosis.diagnose import diagnose as diagnose
    from realitygap.studies.diagnosis.experiment import ProposedExperiment as ProposedExperiment
    from realitygap.studies.diagnosis.experiment import experiment as experiment
    from realitygap.studies.diagnosis.result import DiagnosisResult as DiagnosisResult
    from realitygap.studies.diagnosis.rules import rules as rules
    from realitygap.studies.gain.measure import GainFailed as GainFailed
    from realitygap.studies.gain.measure import gain as gain
    from realitygap.studies.gain.result import GainResult as GainResult
    from realitygap.studies.gap.measure import GapResult as GapResult
    from realitygap.studies.gap.measure import measure_gap as measure_gap
    from realitygap.studies.gap.replay import replay as replay
    from realitygap.studies.health.reference import measure_health as measure_health
    from realitygap.studies.hidden.catalogue import causes as causes
    from realitygap.studies.hidden.catalogue import effects as effects
    from realitygap.studies.inputs.imported import guessed_map as guessed_map
    from realitygap.studies.inputs.imported import import_log as import_log
    from realitygap.studies.inputs.imported import read_log as read_log
    from realitygap.studies.inputs.imported import topics as topics
    from realitygap.studies.inputs.logs import Log as Log
    from realitygap.studies.inputs.model import Model as Model
    from realitygap.studies.plumbing.execution import Unfinished as Unfinished
    from realitygap.studies.replay.watch import watch as watch
    from realitygap.studies.run.capture import capture as capture
    from realitygap.studies.run.simulate import RunResult as RunResult
    from realitygap.studies.run.simulate import simulate as simulate
    from realitygap.studies.study import StudyResult as StudyResult

_WHERE = {
    "DiagnosisResult": "studies.diagnosis.result",
    "Diverged": "embedded_sim.errors",
    "GainFailed": "studies.gain.measure",
    "GainResult": "studies.gain.result",
    "GapResult": "studies.gap.measure",
    "InputError": "embedded_sim.errors",
    "Log": "studies.inputs.logs",
    "Model": "studies.inputs.model",
    "ProposedExperiment": "studies.diagnosis.experiment",
    "Rules": "models.naming.rules",
    "RunResult": "studies.run.simulate",
    "StudyResult": "studies.study",
    "Unfinished": "studies.plumbing.execution",
    "blind": "studies.blind.battery",
    "capture": "studies.run.capture",
    "causes": "studies.hidden.catalogue",
    "demo": "studies.demo.demo",
    "diagnose": "studies.diagnosis.diagnose",
    "effects": "studies.hidden.catalogue",
    "experiment": "studies.diagnosis.experiment",
    "gain": "studies.gain.measure",
    "guessed_map": "studies.inputs.imported",
    "import_log": "studies.inputs.imported",
    "measure_gap": "studies.gap.measure",
    "measure_health": "studies.health.reference",
    "new_model": "models.belief.new_model",
    "read_log": "studies.inputs.imported",
    "replay": "studies.gap.replay",
    "rules": "studies.diagnosis.rules",
    "simulate": "studies.run.simulate",
    "study": "studies",
    "topics": "studies.inputs.imported",
    "watch": "studies.replay.watch",
}
"""Module of each public name: imported when it is asked for, so that starting costs little."""

__all__ = sorted(_WHERE)


def __getattr__(name: str) -> Any:
    where = _WHERE.get(name)
    if where is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "study":
        return importlib.import_module(f"{__name__}.{where}.study")
    return getattr(importlib.import_module(f"{__name__}.{where}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
