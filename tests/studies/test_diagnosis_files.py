from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import realitygap as rg
from realitygap.embedded_sim import Drive, InputError
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.log.measured import write_table
from realitygap.studies.inputs.logs import read_logs
from tests.models.small import driven_log


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "log.csv"
    wide = Drive(wheel_radius=(0.0202, 0.0208))
    frame = driven_log(3, robots=1, rows=700, drive=wide, position_noise=5e-4, heading_noise=5e-3)
    write_table(frame, path)
    return path


def test_a_diagnosis_is_a_json_a_model_and_a_page(log: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    model = tmp_path / "open.toml"
    robot = "wheel_radius = 0.0205\naxle = 0.053\nbody_radius = 0.035\nwheel_speed_max = 6.28\n"
    model.write_text(f'name = "a robot in the open"\n[robot]\n{robot}')
    found = rg.diagnose(log, model=model, out=out)
    content = json.loads((out / "diagnosis.json").read_text())
    assert content["schema"] == 2
    assert content["verdict"] == found.verdict
    assert "wheel_radius_mismatch" in [cause["name"] for cause in content["causes"]]
    extended = read_model_file(out / "extended.toml")
    assert extended.extension is not None
    assert len(extended.extension.log) == 64
    assert [one["option"] for one in content["inputs"]] == ["LOG", "--model"]
    assert [one["file"] for one in content["inputs"]] == [str(log), str(model)]
    assert content["inputs"][0]["sha256"] == extended.extension.log
    assert len(content["versions"]["program"]) == 64
    page = (out / "report.html").read_text()
    assert "wheel_radius_mismatch" in page
    assert "What this log can tell" in page
    told = content["log"]["preflight"]
    assert {"row_rate", "position_noise", "yaw_like", "reference_step"} <= {e["name"] for e in told}
    assert all(entry["meaning"].replace("'", "&#39;") in page for entry in told)
    assert list(found.preflight["name"]) == [entry["name"] for entry in told]
    assert "silences: not checked (ambient_light, lamp_decay" in page
    assert "http" not in page.replace("http-equiv", "")


def test_what_is_there_is_kept_unless_forced(log: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--out"):
        rg.diagnose(log, out=tmp_path)


def test_two_logs_are_one_log_of_two_runs(log: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.csv"
    write_table(driven_log(4, robots=1, rows=700), other)
    both = read_logs((log, other), read_model_file("epuck"))
    assert both.segments["run"].nunique() == 2
    assert both.segments["robot"].nunique() == 1


def test_a_log_given_twice_is_refused(log: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.csv"
    copy.write_bytes(log.read_bytes())
    for again in (log, copy):
        with pytest.raises(InputError, match="the same log as"):
            read_logs((log, again), read_model_file("epuck"))


def test_body_commands_are_read_by_the_geometry_without_the_extension(tmp_path: Path) -> None:
    frame = driven_log(3, robots=1, rows=700)
    left, right = frame.pop("cmd_left"), frame.pop("cmd_right")
    frame["cmd_v"] = 0.0205 * (left + right) / 2
    frame["cmd_omega"] = 0.0205 * (right - left) / 0.053
    write_table(frame, tmp_path / "log.csv")
    value = ParameterValue(value=1.2)
    cause = NamedCause(name="wheel_separation", parameters={"scale": value})
    model = read_model_file("epuck").model_copy(update={"extension": Extension(causes=(cause,))})
    commands = read_logs((tmp_path / "log.csv",), model).commands
    assert np.allclose(commands, np.column_stack([left, right]))


def test_logs_of_different_commands_are_refused(log: Path, tmp_path: Path) -> None:
    frame = driven_log(3, robots=1, rows=100).rename(
        columns={"cmd_left": "cmd_v", "cmd_right": "cmd_omega"}
    )
    write_table(frame, tmp_path / "body.csv")
    model = read_model_file("epuck")
    for logs in ((log, tmp_path / "body.csv"), (tmp_path / "body.csv", log)):
        with pytest.raises(InputError, match=rf"{logs[1].name}.*as in .*{logs[0].name}"):
            read_logs(logs, model)


def test_a_missing_reference_is_refused(log: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--reference"):
        rg.diagnose(log, reference="nowhere.json", out=tmp_path / "out")
    with pytest.raises(InputError, match="LOG"):
        rg.measure_health(out=tmp_path / "r.json")


def test_a_reference_by_a_model_whose_tables_are_missing_is_refused_before_anything_runs(
    log: Path, tmp_path: Path
) -> None:
    model = tmp_path / "mine.toml"
    robot = "wheel_radius = 0.0205\naxle = 0.053\nbody_radius = 0.035\nwheel_speed_max = 6.28\n"
    model.write_text(f'name = "x"\n[robot]\n{robot}[sensors]\ntables = "nowhere.npz"\n')
    with pytest.raises(InputError, match="nowhere"):
        rg.measure_health(log, model=model, out=tmp_path / "r.json")
