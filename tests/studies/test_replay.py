"""`realitygap replay`: a log as something to watch."""

from __future__ import annotations

import base64
import html
import json
import re
import shutil
import subprocess
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from typer.testing import CliRunner

import realitygap as rg
from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.studies.cli import app
from realitygap.studies.replay.packed import FINE, RAY_STEPS, TURN_BITS, packed
from realitygap.studies.replay.scene import CELLS, Scene, scenes
from realitygap.studies.replay.sight import rays
from tests.models.small import driven_log

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
HOSTILE = '</script><img src="http://example.com/x.png" onerror="missing()">'
OPEN = 'name = "in the open"\n[robot]\nwheel_radius = 0.0205\naxle = 0.053\nbody_radius = 0.035\n'
BODY = 0.035


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run in which food is brought home and robots believe something of the lamp."""
    out = tmp_path_factory.mktemp("replay") / "run"
    rg.simulate(minutes=1.2, robots=5, seed=1, out=out)
    return out


@pytest.fixture(scope="module")
def page(run: Path) -> Path:
    out = run.parent / "replay.html"
    rg.watch(run, out)
    return out


@pytest.fixture
def open_model(tmp_path: Path) -> Path:
    path = tmp_path / "open.toml"
    path.write_text(OPEN + "wheel_speed_max = 6.28\n")
    return path


def about(page: Path) -> dict[str, Any]:
    """What a page's script reads."""
    text = page.read_text(encoding="utf-8")
    (content,) = re.findall(r'<script type="application/json" id="about">(.*?)</script>', text)
    return dict(json.loads(content))


def unpacked(found: dict[str, Any]) -> dict[str, FloatArray]:
    """A scene's numbers as documented, written anew: 6 words, flags, and what else there is."""
    shape = (len(found["robots"]), found["frames"])
    raw = np.frombuffer(zlib.decompress(base64.b64decode(found["data"])), dtype=np.uint8)
    size, at, columns = shape[0] * shape[1], 0, []
    for _ in range(6):
        low, high = raw[at : at + size].astype(int), raw[at + size : at + 2 * size].astype(int)
        columns.append(np.cumsum((low + 256 * high).reshape(shape), axis=1).astype(np.int16))
        at += 2 * size
    octets = []
    for _ in range(1 + 8 * found["rays"] + 8 * found["light"]):
        octets.append(np.cumsum(raw[at : at + size].reshape(shape), axis=1) % 256)
        at += size
    assert len(raw) - at == found["frames"]
    words = np.stack(columns, axis=-1).astype(float)
    x, y = found["origin"]
    unit, turn = found["unit"], 2 * np.pi / 2**TURN_BITS
    scale, zero = np.array([unit, unit, turn]), np.array([x, y, 0.0])
    return {
        "poses": words[..., :3] * scale + zero,
        "ghosts": words[..., 3:] * scale + zero,
        "flags": octets[0],
        "rest": np.array(octets[1:]),
    }


def test_what_robots_carry_is_told_from_their_virtual_sensors(run: Path) -> None:
    """Just as the run itself recorded every deposit."""
    (scene,) = scenes(rg.read_log(run), 5.0)
    deposits = pd.read_parquet(run / "deposits.parquet")
    assert len(deposits) > 3
    assert scene.carries is not None
    robot, frame = np.nonzero(scene.carries[:, :-1] & ~scene.carries[:, 1:])
    seen = sorted(zip(robot.tolist(), np.round(scene.times[frame + 1], 2).tolist(), strict=True))
    wanted = deposits[["robot", "t"]].round(2).itertuples(index=False, name=None)
    assert seen == sorted(wanted)


def test_a_run_tells_what_its_robots_believed(run: Path, page: Path) -> None:
    generations = pd.read_parquet(run / "generations.parquet")
    (told,) = about(page)["runs"]
    for robot, rows in generations.groupby("robot"):
        believed = told["beliefs"][int(str(robot))]
        rows = rows.sort_values("generation")
        assert [third for _, _, third, _ in believed] == rows["s0_third"].tolist()
        assert [s0 for *_, s0 in believed] == rows["s0"].tolist()
    alone = rg.read_log(run / "samples.parquet")
    assert not scenes(alone, 5.0)[0].beliefs


def test_a_ghost_of_a_true_model_is_where_the_robot_is(open_model: Path) -> None:
    log = rg.read_log(driven_log(4, robots=2, rows=600), model=open_model)
    (scene,) = scenes(log, 5.0)
    assert scene.poses.shape == (2, 600, 3)
    off = scene.poses - scene.ghosts
    assert np.abs(off[..., :2]).max() < 1e-6
    assert np.abs(np.sin(off[..., 2])).max() < 1e-6


def test_a_ghost_drifts_until_it_begins_anew(open_model: Path) -> None:
    odd = Drive(wheel_radius=(0.0190, 0.0215))
    log = rg.read_log(driven_log(4, robots=1, rows=600, drive=odd), model=open_model)
    (scene,) = scenes(log, 2.0)
    off = np.hypot(*(scene.poses - scene.ghosts)[0, :, :2].T)
    begins = np.flatnonzero(off < 1e-9)
    assert begins.tolist() == list(range(0, 600, 50))
    assert off[begins[1:] - 1].max() > 0.01


def test_a_lost_robot_is_not_shown_and_its_ghost_goes_on(open_model: Path) -> None:
    frame = driven_log(4, robots=1, rows=600)
    frame.loc[200:280, ["x", "y", "yaw"]] = np.nan
    frame.loc[400:403, ["x", "y", "yaw"]] = np.nan
    (scene,) = scenes(rg.read_log(frame, model=open_model), 5.0)
    seen = np.isfinite(scene.poses[0, :, 0])
    assert not seen[205:275].any()
    assert seen[400:404].all()  # a moment is bridged
    assert np.isfinite(scene.ghosts[0, 200:250, 0]).all()


def test_nothing_is_predicted_across_a_gap(open_model: Path) -> None:
    frame = driven_log(4, robots=1, rows=600).drop(index=range(300, 400))
    (scene,) = scenes(rg.read_log(frame, model=open_model), 60.0)
    assert not np.isfinite(scene.ghosts[0, 310:395, 0]).any()
    off = (scene.poses - scene.ghosts)[0, [399, 400, 401], 0]
    assert off[1] == pytest.approx(0.0, abs=1e-9)


def test_robots_of_different_rates_and_clocks_share_one_time(open_model: Path) -> None:
    slow = np.cumsum(np.random.default_rng(1).uniform(0.05, 0.15, 200)) + 3.0
    first = driven_log(1, robots=1, rows=600)
    second = driven_log(2, robots=1, rows=200, t=slow).assign(robot=1)
    log = rg.read_log(pd.concat([first, second]), model=open_model)
    (scene,) = scenes(log, 5.0)
    assert np.isfinite(scene.poses[0, :590, 0]).all()
    assert not np.isfinite(scene.poses[1, : int(2.9 / scene.step), 0]).any()
    off = np.hypot(*(scene.poses - scene.ghosts)[..., :2].reshape(-1, 2).T)
    assert np.nanmax(off) < 2e-3  # a straight line in place of an arc of at most 0.15 s


def test_a_long_log_has_fewer_frames_a_second(open_model: Path) -> None:
    long = driven_log(1, robots=2, rows=100_000)
    (scene,) = scenes(rg.read_log(long, model=open_model), 5.0)
    assert 0.9 * CELLS < scene.poses.shape[0] * scene.poses.shape[1] <= CELLS + 2


def test_clocks_that_are_years_apart_fill_no_memory(open_model: Path) -> None:
    frame = driven_log(1, robots=2, rows=300)
    frame.loc[frame["robot"] == 1, "t"] += 1.6e9
    (scene,) = scenes(rg.read_log(frame, model=open_model), 5.0)
    assert scene.poses.shape[0] * scene.poses.shape[1] <= CELLS + 2


@given(
    seed=st.integers(0, 2**32 - 1),
    robots=st.integers(1, 3),
    frames=st.integers(1, 40),
    far=st.sampled_from([0.0, 0.3, 900.0, 4e6]),
)
def test_a_packed_scene_comes_back_to_the_unit(
    seed: int, robots: int, frames: int, far: float
) -> None:
    rng = np.random.default_rng(seed)
    poses = far + rng.normal(size=(robots, frames, 3)) * [1.0, 1.0, 30.0]
    ghosts = poses + rng.normal(0.0, 0.1, poses.shape)
    poses[rng.random((robots, frames)) < 0.2] = np.nan
    seen = rng.uniform(0.0, 0.1, (robots, frames, 8))
    seen[rng.random(seen.shape) < 0.5] = np.nan
    scene = Scene(
        run="a",
        begin=0.0,
        step=0.04,
        robots=tuple("abc"[:robots]),
        poses=poses,
        ghosts=ghosts,
        carries=rng.random((robots, frames)) < 0.5,
        rays=seen,
        light=None,
        lamp=np.zeros(frames, dtype=np.int8),
        beliefs={},
    )
    found = packed(scene, BODY, 0.1)
    back = unpacked(found)
    assert found["unit"] >= FINE * BODY
    known = np.isfinite(poses[..., 0])
    assert (back["flags"].astype(int) & 1 == known).all()
    assert (back["flags"].astype(int) & 4 == 4 * scene.carries).all()
    for name, wanted, where in (("poses", poses, known), ("ghosts", ghosts, known | True)):
        off = (back[name] - wanted)[where]
        assert np.abs(off[:, :2]).max(initial=0.0) <= 0.51 * found["unit"]
        turned = (off[:, 2] + np.pi) % (2 * np.pi) - np.pi
        assert np.abs(turned).max(initial=0.0) <= 0.51 * 2 * np.pi / 2**TURN_BITS
    lengths = np.moveaxis(back["rest"], 0, -1)
    assert ((lengths == 0) == np.isnan(seen)).all()
    there = lengths > 0
    assert np.abs((lengths[there] - 1) / RAY_STEPS * 0.1 - seen[there]).max(initial=0.0) < 1e-3


def test_a_ray_ends_at_the_wall_that_would_be_read_so() -> None:
    model = rg.Model.load().point()
    assert model.tables is not None
    table = model.tables.ps_counts[:, :, -1].astype(float)
    distance = model.tables.ps_range * np.linspace(0.0, 1.0, table.shape[1]) ** 2
    nodes = np.flatnonzero((table > 50.0).all(axis=0))[1:]
    for node in nodes.tolist():
        found = rays(table[:, node], model)
        assert np.allclose(found, distance[node], atol=2e-3), node
    assert np.isnan(rays(np.zeros(8), model)).all()


def test_ten_robots_for_ten_minutes_stay_below_five_megabytes(tmp_path: Path) -> None:
    """With a tracker as noisy as they come, and sensors that never rest."""
    rows = 15_000
    frame = driven_log(1, robots=10, rows=rows, position_noise=2e-3, heading_noise=0.02)
    rng = np.random.default_rng(2)
    frame["x"] = 0.5 * np.sin(frame["x"])  # within the arena, as far as its size matters
    ps = {f"ps{k}": rng.integers(0, 400, len(frame)) for k in range(8)}
    ls = {f"ls{k}": rng.integers(0, 4095, len(frame)) for k in range(8)}
    log = rg.read_log(frame.assign(x=driven_log(1, robots=10, rows=rows)["x"], **ps, **ls))
    done = rg.watch(log, tmp_path / "replay.html")
    assert done["runs"][0]["frames"] == rows
    assert done["bytes"] < 5e6


def test_hostile_names_stay_text(tmp_path: Path, open_model: Path) -> None:
    frame = driven_log(1, robots=2, rows=200).replace({"robot": {0: HOSTILE[:60], 1: "b"}})
    rg.watch(
        rg.read_log(frame.assign(run=HOSTILE), model=open_model),
        tmp_path / "replay.html",
        title=HOSTILE,
    )
    text = (tmp_path / "replay.html").read_text(encoding="utf-8")
    assert "<img" not in text
    assert text.count("</script>") == 2
    assert about(tmp_path / "replay.html")["runs"][0]["run"] == HOSTILE


def test_the_command_ends_with_its_result_and_replaces_only_replays(
    run: Path, tmp_path: Path
) -> None:
    out = tmp_path / "replay.html"
    words = ["replay", str(run), "--out", str(out)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[-1].startswith("5 robots, 72 s, ")
    assert done.stdout.endswith(f". See {out}\n")
    with pytest.raises(rg.InputError, match="does not exist yet"):
        rg.watch(run, out)
    told = CliRunner().invoke(app, [*words, "--force", "--json", "--restart", "2"])
    content = json.loads(told.stdout)
    assert content["format"] == "html"
    assert content["bytes"] == out.stat().st_size
    assert about(out)["restart"] == content["restart"] == 2.0
    (tmp_path / "thesis.html").write_text("my thesis")
    with pytest.raises(rg.InputError, match="to replace that this command has written"):
        rg.watch(run, tmp_path / "thesis.html", force=True)
    assert (tmp_path / "thesis.html").read_text() == "my thesis"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"out": "x.avi"}, "--out: got x.avi, expected a file ending in .html or .rrd"),
        ({"out": "x.gif", "format": "html"}, "a file ending in .html"),
        ({"out": "x.gif", "format": "flash"}, "--format: got 'flash'"),
        ({"out": "x.html", "restart": 0.0}, "--restart: got 0"),
        ({"out": "x.html", "restart": float("nan")}, "--restart: got nan"),
        ({"out": "x.html", "model": "epuk"}, "did you mean epuck"),
    ],
)
def test_what_cannot_be_written_is_one_error(
    words: dict[str, Any], said: str, tmp_path: Path
) -> None:
    given = {**words, "out": tmp_path / words["out"]}
    with pytest.raises(rg.InputError, match=re.escape(said)):
        rg.watch(driven_log(rows=50), **given)
    assert not list(tmp_path.iterdir())


def test_what_a_format_needs_is_asked_for_in_one_line(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setattr("realitygap.studies.replay.recording.find_spec", lambda name: None)
    with pytest.raises(rg.InputError, match="ffmpeg to be installed"):
        rg.watch(run, tmp_path / "x.mp4")
    with pytest.raises(rg.InputError, match=re.escape("pip install 'reality-gap[rerun]'")):
        rg.watch(run, tmp_path / "x.rrd")


def test_a_film_shows_robots_that_move(run: Path, tmp_path: Path) -> None:
    short = rg.read_log(run).table.query("t < 2")
    rg.watch(short, tmp_path / "replay.gif")
    with Image.open(tmp_path / "replay.gif") as film:
        pictures = []
        for k in (0, film.n_frames - 1):
            film.seek(k)
            pictures.append(np.asarray(film.convert("RGB"), dtype=int))
    assert film.n_frames == 20
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 50).sum() > 200


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_a_film_is_also_written_by_ffmpeg(run: Path, tmp_path: Path) -> None:
    short = rg.read_log(run).table.query("t < 1")
    for force in (False, True):
        done = rg.watch(short, tmp_path / "replay.mp4", force=force)
    assert done["bytes"] > 1000


def test_rerun_gets_robots_and_ghosts_under_their_names(run: Path, tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    frame = rg.read_log(run).table.query("t < 2").replace({"robot": {0: "/a b/"}})
    done = rg.watch(frame, tmp_path / "replay.rrd", format="rerun")
    content = (tmp_path / "replay.rrd").read_bytes()
    assert len(content) == done["bytes"]
    for name in (b"robot/heading", b"ghost", b"off_m", b"arena", rb"\/a\ b\/"):
        assert name in content
    again = rg.watch(frame, tmp_path / "replay.rrd", force=True)
    assert again["format"] == "rerun"


LOOK = """
<script>
const waited = setInterval(() => {
  if (document.documentElement.dataset.ready === undefined) return;
  clearInterval(waited);
  const press = (key) => document.body.dispatchEvent(
    new KeyboardEvent("keydown", {key, bubbles: true, cancelable: true}));
  document.body.style.width = "WIDTHpx";  // a window without a screen is never below 500
  const seen = {wide: document.body.scrollWidth - WIDTH, times: []};
  for (const key of ["ArrowRight", "ArrowRight", "ArrowLeft", "End", "Home", "ArrowUp"]) {
    press(key);
    seen.times.push(state.time);
  }
  seen.speed = state.speed;
  went(30.1);
  seen.poses = state.scene.robots.map((_, k) => poseOf(k));
  seen.ghosts = state.scene.robots.map((_, k) => ghostOf(k));
  seen.brought = state.scene.brought.at(-1);
  seen.rows = [...byId("robots").rows].map((row) => row.innerText);
  const ink = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  seen.ink = ink.filter((value, k) => k % 4 === 3 && value).length;
  press(" ");
  seen.playing = state.playing;
  document.body.dataset.seen = JSON.stringify(seen);
}, 20);
</script></body>"""


def opened(page: Path, scratch: Path, width: int, dark: bool) -> tuple[dict[str, Any], list[str]]:
    """What a page in Chromium says of itself, and its console."""
    assert CHROMIUM is not None
    asking, look = scratch / "asking.html", LOOK.replace("WIDTH", str(width))
    asking.write_text(page.read_text(encoding="utf-8").replace("</body>", look), encoding="utf-8")
    words = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"]
    words += ["--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr"]
    words += [f"--user-data-dir={scratch / 'profile'}", f"--window-size={max(width + 20, 500)},900"]
    words += [f"--blink-settings=preferredColorScheme={int(not dark)}"]
    words += ["--virtual-time-budget=5000", "--dump-dom", asking.as_uri()]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300, check=True)
    (seen,) = re.findall(r'data-seen="(.*?)"', done.stdout)
    console = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
    return json.loads(html.unescape(seen)), console


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
@pytest.mark.parametrize(("width", "dark"), [(1280, False), (390, True)])
def test_the_page_plays(run: Path, page: Path, tmp_path: Path, width: int, dark: bool) -> None:
    seen, console = opened(page, tmp_path, width, dark)
    assert console == []
    assert seen["wide"] <= 0
    assert seen["times"] == pytest.approx([1, 2, 1, 71.96, 0, 0])
    assert (seen["speed"], seen["playing"]) == (10, True)
    (scene,) = scenes(rg.read_log(run), 5.0)
    assert seen["brought"] == len(pd.read_parquet(run / "deposits.parquet"))
    between = 0.5 * (scene.poses[:, 752] + scene.poses[:, 753])  # 30.1 s is between two frames
    assert np.allclose(np.array(seen["poses"])[:, :2], between[:, :2], atol=1e-3)
    assert len(seen["rows"]) == 5
    robot = scene.beliefs["0"][0]
    lamp = ("opposite the nest", "no lamp", "at the nest")[robot.third]
    assert f"{lamp}, {robot.s0:.2f}" in seen["rows"][0]
    assert seen["ink"] > 5000


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_names_from_outside_are_shown_as_they_are(tmp_path: Path, open_model: Path) -> None:
    frame = driven_log(1, robots=1, rows=1000).replace({"robot": {0: HOSTILE[:60]}})
    rg.watch(rg.read_log(frame, model=open_model), tmp_path / "replay.html", title=HOSTILE)
    seen, console = opened(tmp_path / "replay.html", tmp_path, 390, False)
    assert console == []
    assert seen["wide"] <= 0
    assert seen["rows"][0].startswith(HOSTILE[:60])
