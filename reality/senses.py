"""What the robots and the tracker perceive: arrays filled in place, geometry in C.

All arrays have one row per robot. Noise is drawn from the generators given.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS
from realitygap.reality import constants as k
from realitygap.reality._optics import ffi, lib
from realitygap.reality.engine import Engine
from realitygap.reality.hardware import LAMP_PLACES, FloatArray, Hardware


def optics(arena_radius: float = k.ARENA_RADIUS) -> Any:
    """The C struct `rgo_optics` of the nominal world, but for the wall's radius (m)."""
    return ffi.new(
        "rgo_optics *",
        {
            "body_radius": k.BODY_RADIUS,
            "body_top": k.BODY_TOP,
            "sensor_height": k.SENSOR_HEIGHT,
            "arena_radius": arena_radius,
            "ir_range": k.IR_RANGE,
            "ir_offset": k.IR_OFFSET,
            "ir_noise": k.IR_NOISE,
            "ir_noise_floor": k.IR_NOISE_FLOOR,
            "counts_max": k.COUNTS_MAX,
            "light_dark": k.LIGHT_DARK,
            "light_noise": k.LIGHT_NOISE,
        },
    )


def doubles(array: FloatArray) -> Any:
    """A float64 array's memory for C; the array must outlive the pointer."""
    return ffi.from_buffer("double[]", array, require_writable=array.flags.writeable)


class Infrared:
    """Eight ray-cast proximity sensors per robot: counts A cos(incidence) / (d + 9 mm)^2."""

    def __init__(self, hardware: Hardware, random: np.random.Generator) -> None:
        robots = hardware.robots
        rays = SENSORS * robots
        self.counts: FloatArray = np.zeros((robots, SENSORS))
        self._alive = hardware.ir_alive
        self._wall = hardware.wall_reflectance
        self._law, self._hardware = hardware.laws.infrared, hardware
        self._random = random
        self._start, self._end = np.zeros((rays, 3)), np.zeros((rays, 3))
        self._fraction, self._normals = np.zeros(rays), np.zeros((rays, 2))
        self._reflectance: FloatArray = np.ones(rays)
        self._on_robot: npt.NDArray[np.bool_] = np.zeros(rays, dtype=np.bool_)
        self._owner: npt.NDArray[np.int32] = np.zeros(rays, dtype=np.int32)
        self._gauss, self._uniform = np.zeros((2, rays)), np.zeros((2, rays))
        self._optics, self._robots = optics(hardware.arena_radius), robots
        self._angles = doubles(hardware.sensor_angles)
        self._amplitude = doubles(hardware.ir_amplitude)
        self._outliers = doubles(hardware.ir_outliers)
        self._offset = doubles(hardware.ir_offset)
        self._noise = doubles(hardware.ir_noise)
        self._ends = doubles(self._start), doubles(self._end)
        self._owners = ffi.from_buffer("int32_t[]", self._owner)
        self._hits = doubles(self._fraction), doubles(self._normals), doubles(self._reflectance)
        self._draws = doubles(self._gauss), doubles(self._uniform)
        self._read = doubles(self.counts)

    def sense(self, engine: Engine, poses: FloatArray) -> None:
        """Cast the rays that something can be in front of, and fill `counts`."""
        rays = lib.rgo_rays(
            self._optics,
            self._robots,
            doubles(poses),
            self._angles,
            *self._ends,
            self._owners,
        )
        if rays:
            self._cast(engine, rays)
        self._random.standard_normal(out=self._gauss)
        self._random.random(out=self._uniform)
        lib.rgo_infrared(
            self._optics,
            self._robots,
            doubles(poses),
            self._angles,
            rays,
            self._owners,
            *self._hits,
            self._amplitude,
            self._outliers,
            self._offset,
            self._noise,
            *self._draws,
            self._read,
        )
        if self._law is not None:
            directions = poses[:, 2:] + self._hardware.sensor_angles
            more = np.rint(self.counts + self._law(directions, poses))
            np.clip(more, 0.0, k.COUNTS_MAX, out=self.counts)
        self.counts *= self._alive

    def _cast(self, engine: Engine, rays: int) -> None:
        """What the rays meet, and how well it reflects."""
        start, end = self._start[:rays], self._end[:rays]
        if self._wall == 1.0:
            engine.cast(start, end, self._fraction, self._normals)
            return
        engine.cast(start, end, self._fraction, self._normals, self._on_robot)
        self._reflectance[:] = np.where(self._on_robot, 1.0, self._wall)


class Light:
    """Eight light sensors per robot: inverse square, cosine aperture, robots cast shadows."""

    def __init__(self, hardware: Hardware, random: np.random.Generator) -> None:
        robots = hardware.robots
        self.counts: FloatArray = np.zeros((robots, SENSORS))
        self._hardware, self._random = hardware, random
        self._gauss = np.zeros((robots, SENSORS))
        self._optics, self._robots = optics(), robots
        self._angles = doubles(hardware.sensor_angles)
        self._ambient = doubles(hardware.light_ambient)
        self._gain = doubles(hardware.light_gain)
        self._response = doubles(hardware.light_response)
        self._drawn, self._read = doubles(self._gauss), doubles(self.counts)
        self._lamps = ffi.new("rgo_lamp[]", 1 + len(hardware.windows))
        self._lit = 0
        self._decay, self._law = 0.0, hardware.laws.lamp

    def set_scenario(self, scenario: int) -> None:
        """Put the lamp where one of `embedded_sim.SCENARIOS` has it, or take it away."""
        place, lamp = LAMP_PLACES[scenario], self._hardware.lamp
        lit = list(self._hardware.windows)
        if place is not None:
            lit.insert(0, replace(lamp, x=place[0] + lamp.x, y=place[1] + lamp.y))
        for struct, one in zip(self._lamps, lit, strict=False):
            struct.x, struct.y, struct.height = one.x, one.y, one.height
            struct.power, struct.exponent = one.power * one.scale, one.exponent
        self._lit = len(lit)
        self._decay = 0.0 if place is None else lamp.decay
        self._law = None if place is None else self._hardware.laws.lamp

    def sense(self, poses: FloatArray, time: float = 0.0) -> None:
        """Fill `counts`; `time` (s) since the lamp was lit only matters to one that dims."""
        if self._decay or self._law is not None:
            lamp = self._hardware.lamp
            factor = max(1.0 - self._decay * time, 0.0)
            factor *= 1.0 if self._law is None else self._law(time)
            self._lamps[0].power = lamp.power * lamp.scale * factor
        self._random.standard_normal(out=self._gauss)
        lib.rgo_light(
            self._optics,
            self._robots,
            doubles(poses),
            self._angles,
            self._lit,
            self._lamps,
            self._ambient,
            self._gain,
            self._response,
            self._drawn,
            self._read,
        )
        for law in self._hardware.laws.light:
            np.clip(np.rint(law(self.counts)), 0.0, k.COUNTS_MAX, out=self.counts)


class Tracker:
    """Vicon-like poses, and the virtual sensor computed from them (paper, III-D)."""

    def __init__(self, hardware: Hardware, random: np.random.Generator) -> None:
        robots = hardware.robots
        self.poses: FloatArray = np.zeros((robots, 3))
        self.on_food: npt.NDArray[np.uint8] = np.zeros(robots, dtype=np.uint8)
        self.on_nest: npt.NDArray[np.uint8] = np.zeros(robots, dtype=np.uint8)
        self.item: npt.NDArray[np.int32] = np.zeros(robots, dtype=np.int32)
        self.food: FloatArray = np.zeros((k.FOOD_ITEMS, 2))
        self._random, self._noise = random, np.zeros((robots, 3))
        self._scale = np.array([k.TRACKER_NOISE, k.TRACKER_NOISE, k.TRACKER_YAW_NOISE])
        self._nest, self._robots = hardware.nest, robots
        self._reach = hardware.arena_radius - k.BODY_RADIUS
        self._marked = np.flatnonzero(hardware.markers.any(axis=1))
        self._markers = hardware.markers[self._marked]
        self._law = hardware.laws.tracker
        self._places = doubles(self.poses), doubles(self.food), doubles(self._nest)
        self._virtual = (
            ffi.from_buffer("uint8_t[]", self.on_food),
            ffi.from_buffer("uint8_t[]", self.on_nest),
            ffi.from_buffer("int32_t[]", self.item),
        )

    def place_food(self, item: int, random: np.random.Generator) -> None:
        """Put an item anywhere a robot's centre can reach, outside the nest."""
        while True:
            radius = self._reach * np.sqrt(random.random())
            angle = 2.0 * np.pi * random.random()
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            if np.hypot(x - k.NEST[0], y - k.NEST[1]) >= k.NEST[2]:
                self.food[item] = x, y
                return

    def measure(self, poses: FloatArray) -> None:
        """Fill the measured poses (yaw in [-pi, pi) but for noise) from those of the robots."""
        if len(self._marked):
            poses = poses.copy()
            poses[self._marked] = _seen(poses[self._marked], self._markers)
        if self._law is not None:
            poses = self._law(poses)
        self._random.standard_normal(out=self._noise)
        np.multiply(self._noise, self._scale, out=self._noise)
        np.add(poses, self._noise, out=self.poses)

    def locate(self, carrying: npt.NDArray[np.uint8]) -> None:
        """Fill `on_food`, `on_nest` and `item` from the measured poses."""
        poses, food, nest = self._places
        lib.rgo_virtual_sensor(
            self._robots,
            poses,
            ffi.from_buffer("uint8_t[]", carrying),
            k.FOOD_ITEMS,
            food,
            k.FOOD_RADIUS,
            nest,
            *self._virtual,
        )


def _seen(poses: FloatArray, markers: FloatArray) -> FloatArray:
    """Poses (robots, 3) of markers that sit at (x, y, yaw) in their robots' frames."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y, yaw = markers.T
    return np.stack(
        [
            poses[:, 0] + c * x - s * y,
            poses[:, 1] + s * x + c * y,
            np.remainder(poses[:, 2] + yaw + np.pi, 2.0 * np.pi) - np.pi,
        ],
        axis=1,
    )


class Radio:
    """Infrared messages: heard within 20 cm unless a third robot's body is in between."""

    def __init__(self, robots: int) -> None:
        self.heard: npt.NDArray[np.uint8] = np.zeros((robots, robots), dtype=np.uint8)
        self.messages = 0
        self._optics, self._robots = optics(), robots

    def exchange(self, poses: FloatArray, active: npt.NDArray[np.uint8]) -> None:
        """Fill `heard` (receiver, sender) for the robots that are switched on; count messages."""
        lib.rgo_radio(
            self._optics,
            self._robots,
            doubles(poses),
            ffi.from_buffer("uint8_t[]", active),
            k.RADIO_RANGE,
            ffi.from_buffer("uint8_t[]", self.heard),
        )
        self.messages += int(np.count_nonzero(self.heard))
