"""The sensor-capture protocol: a nominal robot is put before the wall and the lamp, and read.

As in the paper (III-E), the embedded simulator's sensors are tables of raw readings captured from
the robot. Medians over repeated readings survive the infrared's gross outliers.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from realitygap.embedded_sim import SENSORS, Tables
from realitygap.reality import constants as k
from realitygap.reality.hardware import FloatArray, Hardware
from realitygap.reality.rays import ClosedRays
from realitygap.reality.senses import Infrared, Light

PS_DISTANCES, PS_INCIDENCES = 48, 11
"""Nodes of the infrared table: range * u^2 against the cosine of the incidence, both uniform."""
LS_DISTANCES, LS_BEARINGS = 32, 72
"""Nodes of the light table: range * u^2 against the bearing of the lamp from the sensor's axis."""
LS_RANGE = k.LAMP_RADIUS + k.ARENA_RADIUS
"""m: no robot is further from a lamp."""
REPEATS = 128
"""Readings per node."""
FLAT = np.array([[1.0, 0.0]])
"""Outward normal of a flat wall: a grazing ray needs more of it than the arena's curve leaves."""
LAMP_AT_NEST = 2


def capture(
    seed: np.random.SeedSequence, progress: Callable[[float], None] = lambda share: None
) -> Tables:
    """Read a nominal robot's sensors over the tables' axes.

    Args:
        seed: Of the sensors' noise.
        progress: Called with the share done.
    """
    infrared_seed, light_seed = seed.spawn(2)
    hardware = Hardware.nominal(1)
    infrared = Infrared(hardware, np.random.default_rng(infrared_seed))
    ps, noise = _capture_infrared(infrared, hardware, progress)
    light = Light(hardware, np.random.default_rng(light_seed))
    dark, ls = _capture_light(light, hardware, progress)
    return Tables(
        ps_counts=ps,
        ps_range=k.IR_RANGE,
        ps_noise=noise,
        ps_noise_floor=math.sqrt(3.0) * k.IR_NOISE_FLOOR,
        ls_counts=ls,
        ls_range=LS_RANGE,
        ls_dark=dark,
        ls_noise=math.sqrt(3.0) * k.LIGHT_NOISE,
        counts_max=k.COUNTS_MAX,
    )


def _before_wall(sensor_angle: float, distance: float, incidence: float) -> FloatArray:
    """Pose (x, y, yaw) of a sensor this far from the wall at (ARENA_RADIUS, 0), this inclined."""
    rim_x = k.ARENA_RADIUS - distance * math.cos(incidence)
    rim_y = -distance * math.sin(incidence)
    body = k.BODY_RADIUS + 1e-4  # where the rays begin
    return np.array(
        [
            rim_x - body * math.cos(incidence),
            rim_y - body * math.sin(incidence),
            incidence - sensor_angle,
        ]
    )


def _capture_infrared(
    infrared: Infrared,
    hardware: Hardware,
    progress: Callable[[float], None],
) -> tuple[np.ndarray[tuple[int, ...], np.dtype[np.float32]], FloatArray]:
    """Median counts (8, distances, incidences) and the relative half width of the noise (8,)."""
    wall = ClosedRays(np.zeros((0, 3)), k.ARENA_RADIUS, FLAT)
    distances = k.IR_RANGE * np.linspace(0.0, 1.0, PS_DISTANCES) ** 2
    incidences = np.arccos(np.maximum(np.linspace(0.0, 1.0, PS_INCIDENCES), 1e-3))
    table = np.zeros((SENSORS, PS_DISTANCES, PS_INCIDENCES), dtype=np.float32)
    spread: list[list[float]] = [[] for _ in range(SENSORS)]
    for sensor in range(SENSORS):
        angle = float(hardware.sensor_angles[0, sensor])
        for i, distance in enumerate(distances.tolist()):
            for j, incidence in enumerate(incidences.tolist()):
                pose = _before_wall(angle, min(distance, k.IR_RANGE - 1e-3), incidence)
                readings = np.array([_read(infrared, wall, pose)[sensor] for _ in range(REPEATS)])
                median = float(np.median(readings))
                table[sensor, i, j] = median
                if 300.0 < median < 0.5 * k.COUNTS_MAX:
                    deviation = float(np.median(np.abs(readings - median)))
                    spread[sensor].append(deviation / median)
        progress((sensor + 1) / (SENSORS + 1))
    pooled = float(np.median([value for values in spread for value in values]))
    # 1.4826 x the median deviation is a normal's s.d.; a uniform's half width is sqrt(3) s.d.
    return table, np.full(SENSORS, math.sqrt(3.0) * 1.4826 * pooled)


def _read(infrared: Infrared, wall: ClosedRays, pose: FloatArray) -> FloatArray:
    infrared.sense(wall, pose[np.newaxis])
    return infrared.counts.reshape(SENSORS)


def _capture_light(
    light: Light, hardware: Hardware, progress: Callable[[float], None]
) -> tuple[float, np.ndarray[tuple[int, ...], np.dtype[np.float32]]]:
    """Dark counts, and median counts below dark (distances, bearings) of the front-right sensor."""
    light.set_scenario(1)
    dark = float(np.median(_read_light(light, np.zeros(3))))
    light.set_scenario(LAMP_AT_NEST)
    table = np.zeros((LS_DISTANCES, LS_BEARINGS), dtype=np.float32)
    angle = float(hardware.sensor_angles[0, 0])
    for i, u in enumerate(np.linspace(0.0, 1.0, LS_DISTANCES).tolist()):
        for j, bearing in enumerate((2.0 * np.pi * np.arange(LS_BEARINGS) / LS_BEARINGS).tolist()):
            # the lamp lies straight ahead on +x; the sensor's axis is turned away from it
            pose = np.array([k.LAMP_RADIUS - LS_RANGE * u * u, 0.0, np.pi - bearing - angle])
            table[i, j] = dark - float(np.median(_read_light(light, pose)))
    progress(1.0)
    return dark, np.maximum(table, 0.0)


def _read_light(light: Light, pose: FloatArray) -> FloatArray:
    """(repeats,) counts of the front-right sensor."""
    readings = np.empty(REPEATS)
    for n in range(REPEATS):
        light.sense(pose[np.newaxis])
        readings[n] = light.counts[0, 0]
    return readings
