"""The worked examples of CONTRIBUTING.md, executed as they are written there."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from realitygap.models.belief.cause import Cause
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.reality.effects.effect import Effect
from realitygap.reality.hardware import Hardware
from tests.helpers import COMMAND, ENVIRONMENT, ROOT
from tests.studies.test_documents import blocks

ROOMS = ("realitygap", "embedded_sim", "reality", "models", "studies", "tests", "docs")


def files() -> dict[str, str]:
    """The example's files: the code of each block under the path that was named last before it."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    before, *after = text.split("```python\n")
    found = {}
    for part in after:
        code, _, rest = part.partition("```")
        found[re.findall(r"`([\w/]+\.py)`", before)[-1]] = code
        before = rest
    return found


def module(path: str) -> types.ModuleType:
    made = types.ModuleType("example")
    sys.modules["example"] = made  # dataclasses look there
    exec(compile(files()[path], path, "exec"), made.__dict__)
    return made


def test_each_example_is_an_effect_and_a_cause() -> None:
    assert list(files()) == [
        f"{room}/{name}.py"
        for name in ("narrow_tread", "ls_lag")
        for room in ("reality/effects", "models/belief/causes")
    ]


def test_the_worked_example_of_an_effect_works() -> None:
    effect = module("reality/effects/narrow_tread.py").narrow_tread
    cause = module("models/belief/causes/narrow_tread.py").CAUSE
    assert isinstance(effect, Effect)
    assert isinstance(cause, Cause)
    hardware = Hardware.nominal(3)
    effect.apply(hardware, np.array([1]), {"shift": 0.002})
    assert hardware.axle == pytest.approx([0.053, 0.051, 0.053])
    believed = cause.change(Motion(), np.array([0.002]), "")
    assert believed.drive.axle == pytest.approx(0.051)
    assert cause.change(Motion(), np.array([0.0]), "") == Motion()


def test_a_sensor_with_memory_answers_a_step_of_light_exponentially() -> None:
    """Both sides of the example, written apart, against 1 - exp(-t / T)."""
    effect = module("reality/effects/ls_lag.py").ls_lag
    cause = module("models/belief/causes/ls_lag.py").CAUSE
    assert isinstance(effect, Effect)
    assert isinstance(cause, SenseCause)
    hardware = Hardware.nominal(3)
    effect.apply(hardware, np.array([1]), {"seconds": 0.4})
    (law,) = hardware.laws.light
    time = 0.04 * np.arange(26)
    step = np.where(time[:, None] > 0.0, 1000.0, 0.0) * np.ones(8)
    told = np.array([law(np.tile(light, (3, 1))) for light in step])
    risen = 1000.0 * (1.0 - np.exp(-time / 0.4))
    np.testing.assert_allclose(told[:, 1], risen[:, None] * np.ones(8))
    np.testing.assert_array_equal(told[:, [0, 2]], np.stack([step, step], axis=1))
    (memory,) = cause.sense(Belief(), np.array([0.4]), "").memory
    np.testing.assert_allclose(memory(np.hstack([step, step]), time)[:, 8:], told[:, 1])
    np.testing.assert_array_equal(memory(np.hstack([step, step]), time)[:, :8], step)
    assert cause.sense(Belief(), np.array([0.0]), "") == Belief()


@pytest.fixture(scope="module")
def with_memory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the tree with the files of the example."""
    tree = tmp_path_factory.mktemp("memory") / "tree"
    for room in ROOMS:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / room, tree / room, symlinks=True, ignore=ignored)
    shutil.copy2(ROOT / "pyproject.toml", tree)
    for path, code in files().items():
        if "ls_lag" in path:
            (tree / path).write_text(code, encoding="utf-8")
    return tree


def done(words: list[str], tree: Path, where: Path) -> str:
    """What something says that is executed with a copy of the tree."""
    environment = {**ENVIRONMENT, "PYTHONPATH": str(tree)}
    ran = subprocess.run(words, cwd=where, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@pytest.mark.slow
def test_a_sensor_with_memory_is_named_and_no_other_robot_accused(with_memory: Path) -> None:
    typed = blocks("CONTRIBUTING.md", "sh")[-1].replace("\\\n", " ")
    for line in typed.splitlines():
        done([*COMMAND, *shlex.split(line)[1:]], with_memory, with_memory.parent)
    said = json.loads((with_memory.parent / "named" / "diagnosis.json").read_text("utf-8"))
    assert [(one["name"], one["robots"]) for one in said["causes"]] == [("ls_lag", [3])]
    assert said["unexplained"] == []
    found = said["causes"][0]["parameters"]["seconds"]
    assert found["value"] == pytest.approx(0.4, rel=0.05)
    assert found["low"] <= 0.4 <= found["high"]


@pytest.mark.slow
def test_a_sensor_without_lag_keeps_every_bit_and_places_say_what_is_missing(
    with_memory: Path,
) -> None:
    pytest_ = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    nulls = [*pytest_, "tests/reality/test_effects.py", "-k", "ls_lag"]
    assert " passed" in done(nulls, with_memory, with_memory)
    words = [*pytest_, "tests/studies/test_places.py", "-k", "ls_lag"]
    environment = {**ENVIRONMENT, "PYTHONPATH": str(with_memory)}
    ran = subprocess.run(words, cwd=with_memory, env=environment, capture_output=True, text=True)
    assert "ls_lag still needs:" in ran.stdout
    assert 'its entry "ls_lag" of MENU' in ran.stdout
    assert "an effect in reality/effects" not in ran.stdout
