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
    from realitygap.embedded_sim.errors import Diverged, InputError
    from realitygap.models.belief.new_model import new_model
    from realitygap.models.naming.rules import Rules
    from realitygap.studies import study
    from realitygap.studies.blind.battery import blind
    from realitygap.studies.demo.demo import demo
    from realitygap.studies.diagnosis.diagnose import diagnose
    from realitygap.studies.diagnosis.experiment import ProposedExperiment, experiment
    from realitygap.studies.diagnosis.result import DiagnosisResult
    from realitygap.studies.diagnosis.rules import rules
    from realitygap.studies.gain.measure import GainFailed, gain
    from realitygap.studies.gain.result import GainResult
    from realitygap.studies.gap.measure import GapResult, measure_gap
    from realitygap.studies.gap.replay import replay
    from realitygap.studies.health.reference import measure_health
    from realitygap.studies.hidden.catalogue import causes, effects
    from realitygap.studies.inputs.imported import guessed_map, import_log, read_log, topics
    from realitygap.studies.inputs.logs import Log
    from realitygap.studies.inputs.model import Model
    from realitygap.studies.plumbing.execution import Unfinished
    from realitygap.studies.replay.watch import watch
    from realitygap.studies.run.capture import capture
    from realitygap.studies.run.simulate import RunResult, simulate
    from realitygap.studies.study import StudyResult

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

__all__ = [
    "DiagnosisResult",
    "Diverged",
    "GainFailed",
    "GainResult",
    "GapResult",
    "InputError",
    "Log",
    "Model",
    "ProposedExperiment",
    "Rules",
    "RunResult",
    "StudyResult",
    "Unfinished",
    "blind",
    "capture",
    "causes",
    "demo",
    "diagnose",
    "effects",
    "experiment",
    "gain",
    "guessed_map",
    "import_log",
    "measure_gap",
    "measure_health",
    "new_model",
    "read_log",
    "replay",
    "rules",
    "simulate",
    "study",
    "topics",
    "watch",
]


def __getattr__(name: str) -> Any:
    where = _WHERE.get(name)
    if where is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "study":
        return importlib.import_module(f"{__name__}.{where}.study")
    return getattr(importlib.import_module(f"{__name__}.{where}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
