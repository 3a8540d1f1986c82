"""The readers of labs' own formats, each with sound files."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.embedded_sim import Tables
from realitygap.models.belief.curves import tables_of
from realitygap.models.belief.modelfile import load_model
from realitygap.models.log.formats.lerobot import read_lerobot
from realitygap.models.log.formats.mrclam import read_mrclam
from realitygap.models.log.formats.optiodom import TICKS_PER_TURN, read_optiodom
from realitygap.models.log.formats.rosbag import read_bag
from realitygap.models.log.formats.tabular import Asked, Read, read_csv_log
from realitygap.models.log.formats.trajectory import read_euroc, read_tum
from realitygap.models.log.measured import make_log
from tests.fuzz.sound import DRIVE, ROWS, Reader, as_csv, as_parquet, table
from tests.models.bags import commands, poses, together, write_bag
from tests.models.small import driven_log, read_mapped

MAP = """[columns]
t = { from = "stamp", unit = "ms" }
x = { from = "px", unit = "mm" }
y = { from = "py", unit = "mm" }
yaw = { from = "heading", unit = "deg", scale = -1 }
cmd_left = { from = "l", unit = "rpm" }
cmd_right = "r"
robot = "id"
food = "f"

[poses]
file = "poses.csv"
t = { from = "when", unit = "ms" }
"""

RICH = """[columns]
t = { from = "stamp", unit = "iso" }
cmd_left = { from = "l", unit = "mm/s" }
cmd_right = { from = "r", unit = "mm/s" }
wheel_left = { from = "tl", unit = "ticks", per_turn = 512, wraps = 256.0 }
wheel_right = { from = "tr", unit = "ticks", per_turn = 512, wraps = 256.0 }
robot = "name"

[[files]]
file = "seen.csv"
[files.columns]
t = { from = "when", unit = "iso" }
x = "x"
y = "y"
yaw = { quaternion = ["qx", "qy", "qz", "qw"] }
robot = "name"
"""

TOPICS = """clock = "received"
[robots.a]
commands = "/cmd_vel"
poses = "/pose"
"""


def _mapped() -> dict[str, bytes]:
    frame = table()
    told = frame.assign(
        stamp=frame["t"] * 1e3, l=frame["cmd_left"], r=frame["cmd_right"], id=frame["robot"], f=True
    )
    seen = frame.assign(
        when=frame["t"] * 1e3,
        px=frame["x"] * 1e3,
        py=frame["y"] * 1e3,
        heading=np.degrees(frame["yaw"]),
        id=frame["robot"],
    )
    return {
        "map.toml": MAP.encode(),
        "lab.csv": as_csv(told[["stamp", "l", "r", "id", "f"]]),
        "poses.csv": as_csv(seen[["when", "px", "py", "heading", "id"]]),
    }


def _read_mapped(folder: Path) -> object:
    return make_log(read_mapped(folder / "lab.csv", folder / "map.toml"), drive=DRIVE)


def _rich() -> dict[str, bytes]:
    frame = table()
    stamps = pd.to_datetime(frame["t"], unit="s").dt.strftime("%Y-%m-%dT%H:%M:%S.%f")
    name = frame["robot"].map({0: "ann", 1: "bob"})
    turned = (np.arange(len(frame)) * 5) % 256
    radius = 1e3 * DRIVE.wheel_radius[0]
    told = {"stamp": stamps, "l": radius * frame["cmd_left"], "r": radius * frame["cmd_right"]}
    told |= {"tl": turned, "tr": turned, "name": name}
    seen = {"when": stamps, "x": frame["x"], "y": frame["y"], "qx": 0.0, "qy": 0.0, "name": name}
    seen |= {"qz": np.sin(frame["yaw"] / 2), "qw": np.cos(frame["yaw"] / 2)}
    written = pd.DataFrame(told).to_csv(index=False, sep=";", decimal=",")
    return {
        "map.toml": RICH.encode(),
        "lab.csv": written.encode(),
        "seen.csv": as_csv(pd.DataFrame(seen)),
    }


def _trajectory(kind: str) -> dict[str, bytes]:
    """A trajectory (tum or euroc) and a table of commands."""
    frame = driven_log(3, robots=1, rows=ROWS)
    half, t = frame["yaw"] / 2, frame["t"]
    turned = [np.sin(half), np.cos(half)]
    if kind == "tum":
        rows = np.column_stack([t, frame["x"], frame["y"], 0 * t, 0 * t, 0 * t, *turned])
        text = "\n".join(" ".join(f"{v:.6f}" for v in row) for row in rows)
    else:
        rows = np.column_stack(
            [1e9 * t, frame["x"], frame["y"], 0 * t, turned[1], 0 * t, 0 * t, turned[0]]
        )
        text = "\n".join(",".join(f"{v:.6f}" for v in row) for row in rows)
    told = frame[["t", "cmd_left", "cmd_right"]]
    return {"poses.csv": text.encode(), "told.csv": as_csv(told)}


def _read_trajectory(read: Callable[[Path, Asked], Read]) -> Callable[[Path], object]:
    def both(folder: Path) -> object:
        asked = Asked(drive=DRIVE, commands=folder / "told.csv")
        return make_log(read(folder / "poses.csv", asked).table, drive=DRIVE)

    return both


def _lerobot() -> dict[str, bytes]:
    frame = table()
    state = frame[["x", "y", "yaw"]].to_numpy().tolist()
    action = frame[["cmd_left", "cmd_right"]].to_numpy().tolist()
    raw = {"observation.state": state, "action": action, "timestamp": frame["t"]}
    names = {
        "observation.state": {"names": ["x", "y", "yaw"]},
        "action": {"names": {"motors": ["left_wheel", "right_wheel"]}},
    }
    return {
        "info.json": json.dumps({"features": names}).encode(),
        "data.parquet": as_parquet(pd.DataFrame(raw | {"episode_index": frame["robot"]})),
    }


def _curves() -> dict[str, bytes]:
    distance, angle = np.meshgrid(np.linspace(0, 100, 12), [0, 45])
    infrared = {"distance_mm": distance.ravel(), "incidence_deg": angle.ravel()}
    infrared["counts"] = 4000 * np.exp(-distance.ravel() / 30)
    bearing = np.arange(-180, 180, 10)
    light = {"bearing_deg": bearing, "light": np.maximum(np.cos(np.radians(bearing)), 0)}
    return {
        "infrared.csv": as_csv(pd.DataFrame(infrared)),
        "light.csv": as_csv(pd.DataFrame(light)),
    }


def _read_curves(folder: Path) -> object:
    names = ("infrared.csv", "light.csv")
    return tables_of([folder / name for name in names], shipped_tables())


def shipped_tables() -> Tables:
    """Those that come along."""
    tables = load_model().tables
    assert tables is not None
    return tables


def _read_lerobot(folder: Path) -> object:
    for room, name in (("meta", "info.json"), ("data", "data.parquet")):
        (folder / room).mkdir(exist_ok=True)
        (folder / name).replace(folder / room / name)
    return make_log(read_lerobot(folder, Asked(drive=DRIVE)).table, drive=DRIVE)


def _read_guessed(folder: Path) -> object:
    return make_log(read_csv_log(folder / "lab.csv", Asked(drive=DRIVE)).table, drive=DRIVE)


def _guessed() -> dict[str, bytes]:
    frame = table()
    raw = {"stamp_ms": 1e3 * frame["t"], "X": 1e3 * frame["x"], "Y": 1e3 * frame["y"]}
    raw |= {"theta": np.degrees(frame["yaw"]), "vl": frame["cmd_left"], "vr": frame["cmd_right"]}
    return {"lab.csv": as_csv(pd.DataFrame(raw | {"id": frame["robot"]}))}


@cache
def _bag(kind: str) -> dict[str, bytes]:
    """The files of a small bag, and a map of its topics."""
    frame = driven_log(3, robots=1, rows=ROWS)
    left, right = frame["cmd_left"], frame["cmd_right"]
    radius, axle = DRIVE.wheel_radius[0], DRIVE.axle
    frame = frame.assign(
        cmd_v=radius * (left + right) / 2, cmd_omega=radius * (right - left) / axle
    )
    with tempfile.TemporaryDirectory() as room:
        path = Path(room) / "bag"
        made = write_bag(path, kind, together(commands(frame), poses(frame, "/pose")))
        parts = [made] if made.is_file() else sorted(made.iterdir())
        return {"map.toml": TOPICS.encode(), **{part.name: part.read_bytes() for part in parts}}


def _read_bag(name: str) -> Callable[[Path], object]:
    """Reads by the map and by a guess; `name` is of the bag's file, empty: the directory is it."""

    def read(folder: Path) -> object:
        source = folder
        if not name:
            source = folder / "bag"
            source.mkdir(exist_ok=True)
            for part in _bag("ros2"):
                if part != "map.toml":
                    (folder / part).replace(source / part)
        asked = Asked(drive=DRIVE, map=folder / "map.toml")
        read_bag(source / name, replace(asked, map=None))
        return make_log(read_bag(source / name, asked).table, drive=DRIVE)

    return read


def _mrclam() -> dict[str, bytes]:
    frame = driven_log(3, robots=1, rows=ROWS)
    left, right = frame["cmd_left"], frame["cmd_right"]
    radius, axle = DRIVE.wheel_radius[0], DRIVE.axle
    told = np.column_stack(
        [frame["t"], radius * (left + right) / 2, radius * (right - left) / axle]
    )
    seen = frame[["t", "x", "y", "yaw"]].to_numpy()
    texts = {"Odometry": told, "Groundtruth": seen}
    return {
        f"Robot1_{name}.dat": b"# remark\n"
        + "\n".join("\t".join(f"{v:.5f}" for v in row) for row in rows).encode()
        for name, rows in texts.items()
    }


def _optiodom() -> dict[str, bytes]:
    rng = np.random.default_rng(np.random.SeedSequence(4))
    ticks = rng.integers(0, 40, (ROWS, 2))
    forward, turn = 40.0, 0.05  # a circle: ticks and rad in a cycle
    own = [f"{k},{a},{b},0,0,0,{forward},{turn}" for k, (a, b) in enumerate(ticks)]
    yaw = turn * np.arange(ROWS)
    metre = np.pi * sum(DRIVE.wheel_radius) / TICKS_PER_TURN
    x, y = forward * metre * np.cumsum([np.cos(yaw), np.sin(yaw)], axis=1)
    seen = [
        f"{0.05 * k:.2f},{x[k]:.6f},{y[k]:.6f},{yaw[k]:.6f},{ticks[k, 1]},{ticks[k, 0]}"
        for k in range(5, ROWS)
    ]
    return {
        "9.csv": ("Run:1\n" + "\n".join(own)).encode(),
        "9_run-01.csv": "\n".join(seen).encode(),
    }


def _read_optiodom(folder: Path) -> object:
    room = folder / "9"
    room.mkdir(exist_ok=True)
    for name in ("9.csv", "9_run-01.csv"):
        (folder / name).replace(room / name)
    return make_log(read_optiodom(folder, drive=DRIVE), drive=DRIVE)


LABS: dict[str, Reader] = {
    "map": Reader(_read_mapped, _mapped, ("map.toml",)),
    "mapped csv": Reader(_read_mapped, _mapped, ("lab.csv", "poses.csv"), "lab.csv"),
    "rich map": Reader(_read_mapped, _rich, ("map.toml",)),
    "joined csv": Reader(_read_mapped, _rich, ("lab.csv", "seen.csv")),
    "guessed csv": Reader(_read_guessed, _guessed, ("lab.csv",)),
    "tum": Reader(
        _read_trajectory(read_tum), lambda: _trajectory("tum"), ("poses.csv", "told.csv")
    ),
    "euroc": Reader(_read_trajectory(read_euroc), lambda: _trajectory("euroc"), ("poses.csv",)),
    "lerobot": Reader(_read_lerobot, _lerobot, ("info.json", "data.parquet")),
    "curves": Reader(_read_curves, _curves, ("infrared.csv", "light.csv")),
    "map of topics": Reader(_read_bag("bag.mcap"), lambda: _bag("mcap"), ("map.toml",)),
    "mcap": Reader(_read_bag("bag.mcap"), lambda: _bag("mcap"), ("bag.mcap",)),
    "ros 1 bag": Reader(_read_bag("bag.bag"), lambda: _bag("ros1"), ("bag.bag",)),
    "ros 2 bag": Reader(_read_bag(""), lambda: _bag("ros2"), ("bag.db3", "metadata.yaml")),
    "mrclam": Reader(
        lambda f: make_log(read_mrclam(f), drive=DRIVE),
        _mrclam,
        ("Robot1_Odometry.dat", "Robot1_Groundtruth.dat"),
    ),
    "optiodom": Reader(_read_optiodom, _optiodom, ("9.csv", "9_run-01.csv")),
}
