"""Real robots' logs, cut in time and judged beside rivals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.gap.replay import windows
from realitygap.models.log.measured import make_log
from realitygap.studies.measure.real import (
    VARIABLE,
    _commands,
    _sure,
    data_folder,
    data_sets,
    in_time,
)
from realitygap.studies.measure.real_pages import ERRORS, INDEX, PICTURE, real
from tests.models.small import driven_log, shared_data


def test_runs_are_cut_in_their_order() -> None:
    frame = pd.DataFrame({"run": ["b", "b", "a", "c"], "t": [0.0, 1.0, 0.0, 0.0]})
    early, late = in_time(frame)
    assert list(early["run"]) == ["b", "b", "a"]
    assert list(late["run"]) == ["c"]


def test_a_single_run_is_cut_in_the_middle_of_its_time() -> None:
    early, late = in_time(pd.DataFrame({"run": "a", "t": np.arange(10.0)}))
    assert (len(early), len(late)) == (5, 5)
    assert early["t"].max() < late["t"].min()


def test_trees_are_told_the_mean_commands_before_and_within_a_window() -> None:
    frame = driven_log(1, robots=1, rows=200, step=0.05)
    frame[["cmd_left", "cmd_right"]] = [2.0, -3.0]
    log = make_log(frame, drive=Drive())
    given = _commands(log, windows(log, 1.0))
    later = given[40:]  # nothing was told before the log began
    assert later[:, ::2] == pytest.approx(2.0)
    assert later[:, 1::2] == pytest.approx(-3.0)


def test_a_gain_of_few_runs_is_not_made_sure_by_many_windows() -> None:
    rng = np.random.default_rng(2)
    each = rng.normal(0.0, 1.0, 8)
    low, high = _sure(each.repeat(500), np.arange(8).repeat(500), np.random.default_rng(0))
    assert high - low == pytest.approx(2 * 1.96 * each.std() / np.sqrt(8), rel=0.35)


def test_a_folder_without_logs_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=VARIABLE):
        list(data_sets(tmp_path))
    monkeypatch.delenv(VARIABLE, raising=False)
    with pytest.raises(InputError, match="got nothing"):
        data_folder(None)


def test_data_sets_that_are_not_there_are_refused(tmp_path: Path) -> None:
    pytest.importorskip("sklearn")
    (tmp_path / "drive").mkdir()
    driven_log(1, robots=1, rows=5).to_parquet(tmp_path / "drive" / "husky-one.parquet")
    with pytest.raises(InputError, match="--only: got warthog, expected beginnings of names"):
        real(tmp_path / "out", data=tmp_path, only=("warthog",))
    assert not (tmp_path / "out").exists()


def test_a_real_robot_is_predicted_better_than_by_its_minimal_model(tmp_path: Path) -> None:
    folder = shared_data("optiodom").parent
    table = real(tmp_path / "out", data=folder, only=("optiodom-ivanjko-2506",))
    by = table.set_index(["model", "horizon"])["heading"]
    assert by["extended", "5 s"] < 0.7 * by["minimal", "5 s"]
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        ERRORS,
        INDEX,
        PICTURE,
        "optiodom-ivanjko-250620201618.md",
    }
