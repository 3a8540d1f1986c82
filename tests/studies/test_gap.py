import dataclasses
import json
import os
import subprocess

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

import realitygap as rg
from realitygap.embedded_sim import Drive, InputError
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.gap.whole import measure_gap
from realitygap.models.log.measured import make_log
from realitygap.studies.cli import app
from realitygap.studies.fitness_gap.generations import coevolution_gap, read_generations
from realitygap.studies.gap.figures import draw_figures
from realitygap.studies.plumbing.provenance import file_sha256
from tests.helpers import COMMAND, ENVIRONMENT, ROOT, realitygap
from tests.models.small import driven_log, shared_data


def generations(case="light-at-nest", rows=400, *, robot_model=10.0, environment=25.0, seed=0):
    """Generations whose simulated fitness is too high by known amounts."""
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    third = rng.integers(0, 3, rows)
    start = 60.0 * np.arange(rows) % 3600.0
    right = {"light-opposite-nest": 0, "no-light": 1, "light-at-nest": 2}
    second = right.get(case, 0)
    truth = np.where(start < 1800, right.get(case, 2), second)
    real = rng.uniform(0, 60, rows)
    excess = robot_model + environment * (third != truth) + rng.normal(0, 5, rows)
    return pd.DataFrame(
        {
            "run": np.repeat([f"r{k}" for k in range(4)], rows // 4),
            "robot": np.arange(rows) % 10,
            "generation": np.arange(rows),
            "t_start": start,
            "t_end": start + 60.0,
            "case": case,
            "s0_third": pd.array(third, dtype="Int8"),
            "fitness_sim": real + excess,
            "fitness_real": real,
        }
    )


@pytest.mark.parametrize(
    "case", ["light-at-nest", "no-light", "light-opposite-nest", "at-nest-to-opposite"]
)
def test_the_gap_in_fitness_is_split_into_its_two_models(case):
    found = coevolution_gap(generations(case))
    assert found is not None
    report = found.report
    robot, environment = report["robot_model"], report["environment_model"]
    wrong = 1.0 - report["share_right_third"]
    for part, expected in ((robot, 10.0), (environment, 25.0 * wrong)):
        assert part["value"] == pytest.approx(expected, abs=1.5)
        assert part["low"] < part["value"] < part["high"] < part["low"] + 4.0
    assert report["total"]["value"] == pytest.approx(robot["value"] + environment["value"])
    assert len(report["by_robot"]) == 10


def test_generations_that_tell_nothing_are_left_out_and_counted():
    table = generations()
    table.loc[:9, "fitness_sim"] = np.nan
    table.loc[10:14, "s0_third"] = pd.NA
    table.loc[15:19, "t_end"] -= 1.0
    found = coevolution_gap(table)
    assert found is not None
    assert found.report["rows_left_out"] == 20
    assert coevolution_gap(table.iloc[:20]) is None


def test_a_table_of_something_else_is_refused(tmp_path):
    generations().drop(columns="s0_third").to_parquet(tmp_path / "generations.parquet")
    with pytest.raises(InputError, match="s0_third"):
        read_generations(tmp_path / "generations.parquet")


def test_gap_writes_its_report_and_says_it_in_ten_lines(tmp_path):
    driven_log(2, rows=1500, position_noise=5e-4, heading_noise=5e-3).to_csv(
        tmp_path / "log.csv", index=False
    )
    done = realitygap("gap", tmp_path / "log.csv", "--out", tmp_path / "gap")
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "gap" / "gap.json").read_text())
    assert report["schema"] == 1
    assert not report["flagged"]
    log, *model = report["inputs"]
    assert log["file"] == str(tmp_path / "log.csv")
    assert log["sha256"] == file_sha256(tmp_path / "log.csv")
    assert [one["file"] for one in model] == ["epuck", "../captured/epuck.npz"]
    assert 0 < len(report["summary"]) <= 10
    *rest, last = done.stdout.splitlines()
    assert [last.rpartition(" See ")[0], *rest] == report["summary"]
    for name in ("horizons", "maps", "windows"):
        fields = pq.read_schema(tmp_path / "gap" / f"{name}.parquet")
        assert len(pd.read_parquet(tmp_path / "gap" / f"{name}.parquet"))
        assert all(b"unit" in field.metadata for field in fields)
    for name in ("horizons", "shares", "maps", "arena"):
        assert (tmp_path / "gap" / f"{name}.png").stat().st_size > 5000
    for channel in report["channels"]:
        assert sum(channel["shares"].values()) == pytest.approx(1.0)


def test_the_same_log_gives_the_same_report(tmp_path):
    driven_log(1, rows=400).to_csv(tmp_path / "log.csv", index=False)
    for name in ("a", "b"):
        words = ["gap", tmp_path / "log.csv", "--out", tmp_path / name, "--quiet"]
        app([str(word) for word in words], standalone_mode=False)
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes(), path.name


def test_a_directory_with_generations_alone_gives_the_gap_in_fitness(tmp_path):
    (tmp_path / "study").mkdir()
    generations().to_parquet(tmp_path / "study" / "generations.parquet")
    done = realitygap("gap", tmp_path / "study", "--out", tmp_path / "gap")
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "gap" / "gap.json").read_text())
    assert "coevolution" in report
    assert "horizons" not in report
    generated = tmp_path / "study" / "generations.parquet"
    assert report["inputs"][0]["file"] == str(generated)
    assert report["inputs"][0]["sha256"] == file_sha256(generated)


EXTENDED = """name = "extended"
[robot]
wheel_radius = 0.0205
axle = 0.053
body_radius = 0.035
wheel_speed_max = 6.28
[[extension.causes]]
name = "wheel_separation"
[extension.causes.parameters]
scale = { value = 1.1 }
"""


def test_a_model_extended_by_its_cause_leaves_no_gap_of_body_commands(tmp_path):
    wide = Drive(axle=1.1 * 0.053)
    frame = driven_log(3, rows=1500, drive=wide, position_noise=5e-4, heading_noise=5e-3)
    left, right = frame.pop("cmd_left"), frame.pop("cmd_right")
    frame["cmd_v"] = 0.0205 * (left + right) / 2
    frame["cmd_omega"] = 0.0205 * (right - left) / 0.053
    frame.to_csv(tmp_path / "log.csv", index=False)
    flagged = {}
    for name, text in (("minimal", EXTENDED.split("[[")[0]), ("extended", EXTENDED)):
        model = tmp_path / f"{name}.toml"
        model.write_text(text)
        words = ["gap", tmp_path / "log.csv", "--model", model, "--out", tmp_path / name]
        app([str(word) for word in words], standalone_mode=False)
        flagged[name] = report_of(tmp_path / name)["flagged"]
    assert flagged == {"minimal": True, "extended": False}


def test_an_extension_does_not_change_how_fast_an_imported_robot_is_told_to_drive(tmp_path):
    small = EXTENDED.replace("wheel_separation", "wheel_radius_scale").replace("1.1", "0.5")
    (tmp_path / "model.toml").write_text(small.replace("6.28", "0.8"))  # refused beyond 8 rad/s
    frame = driven_log(3, rows=400)
    left, right = frame.pop("cmd_left"), frame.pop("cmd_right")
    frame["cmd_v"] = 0.0205 * (left + right) / 2
    frame["cmd_omega"] = 0.0205 * (right - left) / 0.053
    frame.to_csv(tmp_path / "lab.csv", index=False)
    columns = "\n".join(f'{name} = "{name}"' for name in frame.columns)
    (tmp_path / "map.toml").write_text(f"[columns]\n{columns}\n")
    words = ["import", "csv", tmp_path / "lab.csv", "--map", tmp_path / "map.toml"]
    words += ["--model", tmp_path / "model.toml", "--out", tmp_path / "log.csv"]
    app([str(word) for word in words], standalone_mode=False)
    assert len(pd.read_csv(tmp_path / "log.csv")) == len(frame)


@pytest.mark.parametrize(
    "words",
    [
        ("gap", "none.csv", "--out", "out"),
        ("gap", "empty", "--out", "out"),
        ("gap", "log.csv", "--out", "log.csv"),
        ("gap", "log.csv", "--out", "out", "--model", "epuk"),
        ("gap", "degrees.csv", "--out", "out"),
        ("import", "rosbag", "x", "--out", "out.csv"),
        ("import", "optiodom", "empty", "--out", "out.csv"),
        ("import", "csv", "none.csv", "--out", "out.csv"),
        ("import", "mrclam", "empty", "--out", "out.txt"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(tmp_path, words):
    frame = driven_log(1, rows=400)
    frame.to_csv(tmp_path / "log.csv", index=False)
    frame.assign(yaw=np.degrees(frame["yaw"])).to_csv(tmp_path / "degrees.csv", index=False)
    (tmp_path / "empty").mkdir()
    before = sorted(tmp_path.iterdir())
    paths = {"none.csv", "log.csv", "degrees.csv", "empty", "out", "out.csv", "out.txt"}
    with pytest.raises(InputError) as refusal:
        app([str(tmp_path / w) if w in paths else w for w in words], standalone_mode=False)
    assert "\n" not in str(refusal.value)
    assert sorted(tmp_path.iterdir()) == before


def test_a_real_session_goes_from_the_labs_files_to_a_report(tmp_path):
    source = shared_data("optiodom") / "circular" / "250620202104"
    log = tmp_path / "log.parquet"
    done = realitygap("import", "optiodom", source, "--out", log)
    assert done.returncode == 0, done.stderr
    assert "6 runs, 1 robot," in done.stdout
    done = realitygap("gap", log, "--model", "optiodom", "--out", tmp_path / "gap")
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "gap" / "gap.json").read_text())
    assert [row["horizon"] for row in report["horizons"]] == ["step", "0.4 s", "1 s", "5 s", "20 s"]


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A healthy run, and one in which robot 3 has one larger wheel."""
    where = tmp_path_factory.mktemp("runs")
    wrong = ("--effect", "wheel_radius_mismatch:ratio=1.02,robot=3")
    for name, effect in (("healthy", ()), ("wrong", wrong)):
        words = ("--minutes", 2, "--controller", "search", "--seed", 7, "--out", where / name)
        done = realitygap("run", *words, *effect)
        assert done.returncode == 0, done.stderr
        done = realitygap("gap", where / name, "--out", where / f"{name}-gap")
        assert done.returncode == 0, done.stderr
    return where


def report_of(directory):
    return json.loads((directory / "gap.json").read_text())


def test_a_wheel_two_per_cent_larger_shows_in_its_robot_and_in_no_other(runs):
    report = report_of(runs / "wrong-gap")
    odd = [robot["robot"] for robot in report["robots"] if robot["flagged"]]
    assert odd == ["robot 3"]
    assert any(line.startswith("Robot 3 is unlike the others") for line in report["summary"])


def test_a_healthy_run_shows_the_inherent_gap_and_no_odd_robot(runs):
    report = report_of(runs / "healthy-gap")
    assert report["flagged"]
    assert not any(robot["flagged"] for robot in report["robots"])
    heading = next(
        c for c in report["channels"] if c["channel"] == "heading" and c["horizon"] == "0.4 s"
    )
    assert heading["shares"]["structured"] > 0.2


def test_what_was_hidden_leaves_no_trace_but_in_the_measurements(runs):
    for name in ("truth.json", "run.json"):
        (runs / "wrong" / name).write_text("unreadable")
    done = realitygap("gap", runs / "wrong", "--out", runs / "again")
    assert done.returncode == 0, done.stderr
    assert report_of(runs / "again") == report_of(runs / "wrong-gap")


def usage(*words):
    """What a command uses: s of processor, bytes of memory at most."""
    child = subprocess.Popen(
        [*COMMAND, *map(str, words)], cwd=ROOT, env=ENVIRONMENT, stdout=subprocess.DEVNULL
    )
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    assert child.returncode == 0
    return used.ru_utime + used.ru_stime, 1024 * used.ru_maxrss


@pytest.mark.slow
def test_ten_minutes_of_ten_robots_take_little_time_and_memory(tmp_path):
    took = {}
    for minutes in (10, 20):
        run, out = tmp_path / f"run{minutes}", tmp_path / f"gap{minutes}"
        words = ("--minutes", minutes, "--controller", "search", "--out", run)
        assert realitygap("run", *words).returncode == 0
        took[minutes], memory = usage("gap", run, "--out", out)
        assert memory < 1e9, minutes
    assert took[10] < 20.0
    assert took[20] < 2.2 * took[10]


@pytest.mark.parametrize("every", [2, 3])
def test_a_log_without_a_pose_in_the_middle_of_its_windows_has_a_gap(tmp_path, every):
    frame = driven_log(3, rows=1200, step=0.01, position_noise=5e-4, heading_noise=5e-3)
    row = np.arange(len(frame))
    hole = row % 2 == 1 if every == 2 else (row % 100 >= 45) & (row % 100 < 56)
    frame.loc[hole, ["x", "y", "yaw"]] = np.nan
    frame.to_csv(tmp_path / "log.csv", index=False)
    found = rg.measure_gap(frame, model="create", out=tmp_path / "gap")
    assert (tmp_path / "gap" / "arena.png").exists()
    windows = found.tables["windows"]
    longer = windows[windows["horizon"] != "step"]
    assert len(longer)  # other rows inside the window say where it was
    assert longer[["x", "y"]].notna().all(axis=None)


def test_a_log_that_never_says_where_a_window_was_has_no_picture_of_the_arena(tmp_path):
    log = make_log(driven_log(3, rows=300), drive=Drive())
    model = read_model_file("create")
    found = measure_gap(log, model, model.point_model(), seed=0, name="x")
    lost = [gap._replace(table=gap.table.assign(x=np.nan, y=np.nan)) for gap in found.motion]
    draw_figures(log, dataclasses.replace(found, motion=lost), tmp_path)
    assert (tmp_path / "maps.png").exists()
    assert not (tmp_path / "arena.png").exists()


def test_a_robot_that_stays_in_the_middle_has_a_gap(tmp_path):
    still = {name: np.zeros(300) for name in ("x", "y", "yaw", "cmd_left", "cmd_right")}
    log = make_log(pd.DataFrame({"robot": 0, "t": 0.04 * np.arange(300), **still}), drive=Drive())
    model = read_model_file("create")
    found = measure_gap(log, model, model.point_model(), seed=0, name="x")
    draw_figures(log, found, tmp_path)
    assert (tmp_path / "arena.png").exists()
