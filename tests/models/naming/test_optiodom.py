import numpy as np
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.belief.modelfile import load_model, read_model_file
from realitygap.models.gap.replay import HORIZONS, replay_log
from realitygap.models.gap.whole import horizon_errors
from realitygap.models.log.formats.optiodom import read_optiodom
from realitygap.models.log.measured import make_log
from realitygap.models.log.noise import PoseNoise
from realitygap.models.naming.channels.motion.diagnose import diagnose
from tests.models.small import shared_data

SESSIONS = [
    "circular/231220200121",
    "circular/250620202104",
    "circular/250620202119",
    "ivanjko/231220200102",
    "ivanjko/250620201618",
    "square/230620202042",
    "square/231220200029",
]


def dead_reckoning_errors(directory, seconds):
    """Median position and heading error per run: plain numpy, straight from the session's files."""
    name, cycles = directory.name, round(seconds / 0.05)
    text = (directory / f"{name}.csv").read_text().split("Run:")[1:]
    result = []
    for number, part in enumerate(text, start=1):
        path = directory / f"{name}_run-{number:02d}.csv"
        pose = np.array([line.split(",")[1:4] for line in path.read_text().split()], float)
        lines = [line.split(",") for line in part.splitlines()[1:] if not line.startswith("+")]
        command = np.array([line[6:8] for line in lines[: len(pose)]], float)
        if len(pose) <= cycles:
            continue
        x, y, th = pose[:-cycles].T.copy()
        for k in range(cycles):
            v, w = command[k : len(pose) - cycles + k].T
            v = v * np.pi * 0.084 / 2796.8
            x, y, th = x + v * np.cos(th + w / 2), y + v * np.sin(th + w / 2), th + w
        end = pose[cycles:]
        turn = (end[:, 2] - th + np.pi) % (2 * np.pi) - np.pi
        far = np.hypot(end[:, 0] - x, end[:, 1] - y)
        result.append((np.median(far), np.median(np.abs(turn))))
    return np.array(result)


@pytest.mark.parametrize("session", SESSIONS)
def test_errors_per_horizon_agree_with_an_independent_dead_reckoning(session):
    directory = shared_data("optiodom") / session
    model = load_model("optiodom", sensors="ignored")
    log = make_log(read_optiodom(directory, drive=model.drive), drive=model.drive)
    table = horizon_errors(log, replay_log(log, model.drive), PoseNoise(1e-4, 1e-3))
    for name, seconds in HORIZONS.items():
        part = table[table["horizon"] == name]
        expected = dead_reckoning_errors(directory, seconds or 0.05)
        got = part[["position_median", "heading_median"]].to_numpy()
        assert np.allclose(got, expected.reshape(-1, 2), rtol=0.03), name


def test_the_authors_intermediate_files_are_not_taken_for_runs(tmp_path):
    source = shared_data("optiodom") / SESSIONS[0]
    room = tmp_path / source.name
    room.mkdir()
    for path in source.iterdir():
        (room / path.name).write_bytes(path.read_bytes())
    for name in ("_run-01_odo.csv", "_run-01_opti.csv", "_robot-diff.csv"):
        (room / f"{source.name}{name}").write_text("0.1;2\n")
    drive = load_model("optiodom", sensors="ignored").drive
    assert read_optiodom(tmp_path, drive=drive).equals(read_optiodom(source, drive=drive))


def test_a_directory_of_something_else_is_refused(tmp_path):
    with pytest.raises(InputError, match="run-01"):
        read_optiodom(tmp_path, drive=load_model("optiodom", sensors="ignored").drive)


def test_a_test_skipped_for_want_of_data_says_where_it_looked(tmp_path, monkeypatch):
    monkeypatch.setenv("REALITYGAP_DATA", str(tmp_path))
    with pytest.raises(pytest.skip.Exception) as skipped:
        shared_data("optiodom")
    assert "REALITYGAP_DATA" in str(skipped.value)
    assert str(tmp_path / "optiodom") in str(skipped.value)


def test_a_real_robots_slow_start_stays_unexplained_and_is_calibrated():
    directory = shared_data("optiodom") / "ivanjko" / "250620201618"
    model = read_model_file("optiodom")
    log = make_log(read_optiodom(directory, drive=model.nominal_drive), drive=model.nominal_drive)
    found = diagnose(log, model, None).diagnosis
    assert found.verdict == "unexplained"
    assert "motor_saturation" not in [one.term.cause.name for one in found.named if one.exported]
    (calibrated,) = found.calibration
    before, after = calibrated.errors["heading_5s"]
    assert after < 0.2 * before
