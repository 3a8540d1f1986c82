"""`realitygap run`: the files, their repeatability, and what happens when something goes wrong."""

from __future__ import annotations

import filecmp
import hashlib
import json
import os
import signal
import subprocess
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.genome import CONTINUOUS
from realitygap.models.belief.modelfile import find_model_file
from realitygap.reality import constants as k
from realitygap.studies.run.experiment import RunConfig, simulate
from tests.helpers import COMMAND, LONG, ROOT, realitygap, until

TABLES = ("samples.parquet", "generations.parquet", "deposits.parquet")


def run(out: Path, effects: tuple[str, ...] = (), **config: object) -> Path:
    out.mkdir()
    simulate(RunConfig(**{"minutes": 0.5, "robots": 4, "seed": 3, **config}), effects, out)
    return out


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A co-evolution of 2.5 minutes with six robots: two whole generations each."""
    return run(tmp_path_factory.mktemp("runs") / "run", minutes=2.5, robots=6, seed=1)


def test_a_run_writes_the_tables_the_contract_names(finished: Path) -> None:
    samples = pd.read_parquet(finished / "samples.parquet")
    generations = pd.read_parquet(finished / "generations.parquet")
    deposits = pd.read_parquet(finished / "deposits.parquet")
    assert list(generations.columns) == [
        "run",
        "robot",
        "generation",
        "t_start",
        "t_end",
        "case",
        "s0",
        "s0_third",
        "g0",
        "g1",
        "fitness_sim",
        "fitness_real",
        "deposits",
        "heard",
    ]
    assert list(deposits.columns) == ["run", "robot", "t", "t_pickup", "generation"]
    needed = {"run", "robot", "t", "x", "y", "yaw", "cmd_left", "cmd_right", "food", "nest", "case"}
    assert needed | {f"{kind}{i}" for kind in ("ps", "ls") for i in range(8)} <= set(samples)
    assert len(samples) == 6 * 2.5 * 60 / 0.04
    assert samples.groupby("robot")["t"].apply(lambda t: np.allclose(np.diff(t), 0.04)).all()
    assert set(samples["case"]) == {"light-at-nest"}
    assert pq.read_schema(finished / "samples.parquet").field("yaw").metadata == {b"unit": b"rad"}


def test_the_continuous_genome_adds_its_constants_to_the_generations(tmp_path: Path) -> None:
    out = run(tmp_path / "run", minutes=1.2, genome="continuous", samples=False)
    generations = pd.read_parquet(out / "generations.parquet")
    added = list(generations.columns[14:])
    assert added == [gene.name for gene in CONTINUOUS.continuous]
    for gene in CONTINUOUS.continuous:
        assert generations[gene.name].between(gene.low, gene.high).all()
    assert generations["cruise_speed"].nunique() > 4


def test_fitness_in_reality_follows_from_the_deposits_alone(finished: Path) -> None:
    generations = pd.read_parquet(finished / "generations.parquet")
    deposits = pd.read_parquet(finished / "deposits.parquet")
    assert len(deposits) > 0
    assert generations["deposits"].sum() == len(deposits)
    for row in generations.itertuples():
        own = deposits[(deposits.robot == row.robot) & (deposits.generation == row.generation)]
        assert own["t"].between(row.t_start, row.t_end).all()
        expected = (60.0 - (own["t"] - row.t_start)).sum()
        assert row.fitness_real == pytest.approx(expected)
    assert (deposits["t_pickup"] <= deposits["t"]).all()


def test_the_virtual_sensor_agrees_with_the_measured_poses(finished: Path) -> None:
    samples = pd.read_parquet(finished / "samples.parquet")
    on_nest = np.hypot(samples["x"] - k.NEST[0], samples["y"] - k.NEST[1]) < k.NEST[2]
    assert (on_nest == samples["nest"]).all()


def test_robots_start_asynchronously_and_generations_last_60_s(finished: Path) -> None:
    generations = pd.read_parquet(finished / "generations.parquet")
    first = generations[generations["generation"] == 0]
    assert first["t_start"].nunique() == 6
    assert first["t_start"].max() <= k.START_WITHIN + 0.04
    whole = generations[generations["t_end"] < 149.9]
    assert whole["t_end"].to_numpy() - whole["t_start"].to_numpy() == pytest.approx(60.0)


def test_nothing_that_a_diagnosis_reads_tells_what_was_hidden(tmp_path: Path) -> None:
    hidden = run(tmp_path / "a", ("wheel_radius_mismatch:ratio=1.23456789,robot=1",))
    for path in hidden.iterdir():
        if path.name != "truth.json":
            content = path.read_bytes()
            if path.suffix == ".parquet":
                table = pq.read_table(path)
                words = [c for c in table.schema if "string" in str(c.type)]
                said = {str(v) for c in words for v in set(table[c.name].to_pylist())}
                content += repr((table.schema.metadata, said)).encode()
            assert b"mismatch" not in content
            assert b"1.23456789" not in content
    truth = json.loads((hidden / "truth.json").read_text())
    assert truth == {
        "effects": [
            {"name": "wheel_radius_mismatch", "robots": [1], "parameters": {"ratio": 1.23456789}}
        ]
    }


def test_the_same_configuration_gives_the_same_bytes(tmp_path: Path) -> None:
    first, second = run(tmp_path / "a", minutes=1.1), run(tmp_path / "b", minutes=1.1)
    for name in TABLES:
        assert filecmp.cmp(first / name, second / name, shallow=False)


def test_another_seed_gives_another_run(tmp_path: Path) -> None:
    first, second = run(tmp_path / "a"), run(tmp_path / "b", seed=4)
    assert not filecmp.cmp(first / "samples.parquet", second / "samples.parquet", shallow=False)


@pytest.mark.parametrize(("robots", "minutes"), [(1, 0.1), (2, 0.5), (40, 0.1)])
def test_any_number_of_robots_runs(tmp_path: Path, robots: int, minutes: float) -> None:
    out = run(tmp_path / "a", robots=robots, minutes=minutes)
    samples = pd.read_parquet(out / "samples.parquet")
    assert samples["robot"].nunique() == robots


@pytest.mark.parametrize("controller", ["search", "positive-phototaxis", "negative-phototaxis"])
def test_fixed_controllers_do_not_evolve(tmp_path: Path, controller: str) -> None:
    out = run(tmp_path / "a", controller=controller, minutes=1.2)
    generations = pd.read_parquet(out / "generations.parquet")
    assert generations[["s0", "s0_third", "fitness_sim"]].isna().all(axis=None)
    assert generations["g0"].nunique() == 1


def test_the_lamp_moves_half_way(tmp_path: Path) -> None:
    out = run(tmp_path / "a", case="at-nest-to-opposite")
    cases = pd.read_parquet(out / "samples.parquet").groupby("case", observed=True)["t"]
    assert cases.max()["light-at-nest"] == pytest.approx(15.0 - 0.04)
    assert cases.min()["light-opposite-nest"] == pytest.approx(15.0)


def test_a_hidden_effect_changes_what_is_measured(tmp_path: Path) -> None:
    plain, dead = run(tmp_path / "a"), run(tmp_path / "b", ("ir_dead_sensor:sensor=2",))
    assert pd.read_parquet(plain / "samples.parquet")["ps2"].max() > 0
    assert pd.read_parquet(dead / "samples.parquet")["ps2"].max() == 0


@pytest.mark.parametrize(
    "words",
    [
        ["--case", "bright"],
        ["--controller", "clever"],
        ["--robots", "0"],
        ["--robots", "ten"],
        ["--minutes", "-1"],
        ["--minutes", "nan"],
        ["--seed", "-1"],
        ["--reading", "between-the-lines"],
        ["--trials", "0"],
        ["--genome", "dna"],
        ["--effect", "gremlins:count=3"],
        ["--model", "nowhere.toml"],
        ["--colour", "red"],
    ],
)
def test_bad_input_is_one_line_and_exit_code_2_and_leaves_nothing(
    tmp_path: Path, words: list[str]
) -> None:
    done = realitygap("run", "--minutes", "0.1", "--out", tmp_path / "out", *words)
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert done.stderr.startswith("realitygap: ")
    assert not list(tmp_path.iterdir())


def test_a_broken_model_file_is_refused(tmp_path: Path) -> None:
    model = tmp_path / "model.toml"
    model.write_text("[robot\nwheel_radius = ")
    done = realitygap("run", "--minutes", "0.1", "--model", model, "--out", tmp_path / "out")
    assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1)
    assert [path.name for path in tmp_path.iterdir()] == ["model.toml"]


@pytest.mark.parametrize("controller", ["search", "probe:tour", "coevolution"])
@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "a model file"), ("wheels = 3\n", "wheels"), ("wheels", "TOML")],
)
def test_whoever_drives_a_model_that_cannot_be_used_is_refused(
    controller: str, content: str | None, said: str, tmp_path: Path
) -> None:
    model, out = tmp_path / "mine.toml", tmp_path / "run"
    if content is not None:
        model.write_text(content + find_model_file("epuck").read_text())
    with pytest.raises(InputError, match=said):
        run(out, controller=controller, model=str(model), minutes=0.01)
    assert not list(out.iterdir())


def test_a_run_names_the_files_that_it_read_by_their_content(tmp_path: Path) -> None:
    source = find_model_file("epuck")
    tables = (source.parent / "../captured/epuck.npz").resolve()
    model = tmp_path / "mine.toml"
    model.write_text(source.read_text().replace("../captured/epuck.npz", str(tables)))
    out = run(tmp_path / "run", controller="search", model=str(model), minutes=0.01)
    noted = json.loads((out / "run.json").read_text())
    assert noted["inputs"] == [
        {"option": "--model", "file": str(model), "sha256": sha256(model)},
        {"option": "--model: sensors", "file": str(tables), "sha256": sha256(tables)},
    ]
    plain = json.loads((run(tmp_path / "plain", minutes=0.01) / "run.json").read_text())
    assert [one["file"] for one in plain["inputs"]] == ["epuck", "../captured/epuck.npz"]
    assert plain["versions"]["program"] == noted["versions"]["program"]


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_existing_and_unwritable_output_is_refused(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "keep").write_text("me")
    (tmp_path / "file").write_text("me too")
    for out in ("there", "file", "file/inside"):
        done = realitygap("run", "--minutes", "0.1", "--out", tmp_path / out)
        assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1)
    assert (tmp_path / "there" / "keep").read_text() == "me"
    for out in ("/proc/nothing/here", "/proc/nothing", tmp_path / ("long" * 80)):
        done = realitygap("run", "--minutes", "0.1", "--out", out)
        assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1)


def test_force_replaces_what_is_there(tmp_path: Path) -> None:
    words = ("run", "--minutes", "0.05", "--robots", "2", "--out", tmp_path / "there")
    assert realitygap(*words).returncode == 0
    (tmp_path / "there" / "old").write_text("")
    done = realitygap(*words, "--force")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "there").iterdir()} == {
        *TABLES,
        "run.json",
        "truth.json",
    }
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


def test_force_never_replaces_what_is_not_a_run(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "thesis.tex").write_text("all of it")
    for out in ("home", "."):
        words = ("run", "--minutes", "0.05", "--out", out, "--force")
        done = realitygap(*words, cwd=tmp_path)
        assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1)
    assert (tmp_path / "home" / "thesis.tex").read_text() == "all of it"


def test_a_log_is_never_replaced_by_what_is_said_of_it(finished: Path) -> None:
    before = (finished / "samples.parquet").read_bytes()
    for command in ("gap", "diagnose"):
        assert realitygap(command, finished, "--out", finished, "--force").returncode == 2
    assert (finished / "samples.parquet").read_bytes() == before


@pytest.mark.parametrize(
    ("sent", "code"),
    [
        (signal.SIGINT, 130),
        (signal.SIGTERM, 143),
        (signal.SIGHUP, 129),
        (signal.SIGKILL, -signal.SIGKILL),
    ],
)
def test_an_interrupted_run_leaves_no_table_under_its_final_name(
    tmp_path: Path, sent: signal.Signals, code: int
) -> None:
    words = ["run", "--minutes", "60", "--seed", "1", "--out", str(tmp_path / "out")]
    process = subprocess.Popen(
        [*COMMAND, *words],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.DEVNULL,
    )
    samples = tmp_path / ".out.part/new/out/samples.parquet"
    until(lambda: samples.exists() or process.poll() is not None)
    process.send_signal(sent)
    assert process.wait(timeout=LONG) == code
    assert not (tmp_path / "out").exists()
    if sent != signal.SIGKILL:
        assert not list(tmp_path.iterdir())  # and cleaned up after itself


def test_help_shows_an_example_for_every_command() -> None:
    for command in ("run", "capture", "demo"):
        done = realitygap(command, "--help")
        assert done.returncode == 0
        assert "Example:" in done.stdout
