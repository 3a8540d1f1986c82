"""The menu of manoeuvres: what to let robots do when a log cannot tell two causes apart.

A manoeuvre is a sequence of laps. Before each lap every robot is driven home, to a pose of its own;
then all follow a schedule of wheel speeds, whatever becomes of it. Robots in formation point the
same way and do the same, so that they keep their distance, and point elsewhere in every lap.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.embedded_sim.model import CONTROL_STEP, FloatArray, PointModel

PREFIX = "probe:"
"""Before a manoeuvre's name where it stands for a controller."""

FAST, MIDDLE, SLOW = 6.0, 4.0, 2.0
"""rad/s of the faster wheel: 12.3, 8.2 and 4.1 cm/s of an e-puck. Our choice: the fastest as in its
cruise, the slowest a third of it."""
REACH = 0.13
"""m from home that a robot in formation goes at most."""
SPACING = 0.21
"""m between homes in formation: robots never come nearer than 96 mm, where they disturb."""
MARGIN = 0.025
"""m kept between body and wall: nearer ones count as contact."""
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))
"""rad between the headings of laps: they never repeat and spread evenly."""
TURN = 2.0 * math.pi
REST = 0.2
"""s at rest between two parts of a lap: wheels that change speed slowly have stopped."""
GENTLY = 0.32
"""s from rest to speed where a lap is about geometry: a tenth of what motors and tyres can do."""
TOUR_GAP = 0.12
"""m between the wall and the ring of homes of a tour: the infrared sees the wall from there."""
TOUR_STEP = TURN / 10.0
"""rad that the ring turns between two laps of a tour: round once in ten."""
APART = 0.10
"""m of each robot of a pair from the middle between them: gaps of 130 mm, out of infrared's sight
before they approach."""


@dataclass(frozen=True, eq=False)
class Lap:
    """One round of a manoeuvre."""

    homes: FloatArray
    """(robots, 3) m, m, rad from which it starts."""
    wheels: FloatArray
    """(steps, robots, 2) rad/s, left and right, of every control step."""


@dataclass(frozen=True, kw_only=True)
class Probe:
    """One manoeuvre."""

    name: str
    does: str
    """What the robots do, in words."""
    lap: Callable[[int, int, PointModel], Lap]
    """(number of the lap, robots, what is believed of robot and arena) -> lap.

    Raises InputError where so many robots do not find room."""
    dark: bool = False
    """It needs the lamp switched off."""
    walled: bool = False
    """It is about a wall, the lamp or the nest: in the open it means nothing."""
    least: int = 1
    """Robots without whom it means nothing."""
    formation: bool = False
    """Every robot works about a home of its own, wherever that is."""


def probe(name: str) -> Probe:
    """The manoeuvre of a name.

    Raises:
        InputError: there is none of that name.
    """
    if name not in MENU:
        raise InputError("--controller", repr(PREFIX + name), "probe: " + nearest(name, MENU))
    return MENU[name]


def _way(model: PointModel, ahead: float, turn: float, fastest: float) -> FloatArray:
    """(steps, 2) wheel speeds over a distance (m) and an angle (rad), at most so fast (rad/s).

    They rise and fall evenly within `GENTLY`, so that geometry is seen and not how motors start.
    """
    left, right = model.drive.wheel_radius
    half = 0.5 * model.drive.axle * turn
    angles = np.array([(ahead - half) / left, (ahead + half) / right])
    ramp = round(GENTLY / CONTROL_STEP)
    even = max(0, math.ceil(float(np.abs(angles).max()) / fastest / CONTROL_STEP) - ramp)
    up = (np.arange(ramp) + 0.5) / ramp
    share = np.concatenate([up, np.ones(even), up[::-1]])
    speeds: FloatArray = share[:, None] * angles / (share.sum() * CONTROL_STEP)
    return speeds


def _hold(left: float, right: float, seconds: float) -> FloatArray:
    """(steps, 2) of one pair of wheel speeds (rad/s)."""
    return np.tile([left, right], (round(seconds / CONTROL_STEP), 1))


def _rise(left: float, right: float, seconds: float) -> FloatArray:
    """(steps, 2) from rest evenly up to a pair of wheel speeds and down again."""
    steps = round(seconds / CONTROL_STEP)
    share = 1.0 - np.abs(2.0 * (np.arange(steps) + 0.5) / steps - 1.0)
    speeds: FloatArray = share[:, None] * np.array([left, right])
    return speeds


def _rested(*parts: FloatArray) -> FloatArray:
    """Parts one after the other, with a rest after each."""
    return np.vstack([np.vstack([part, _hold(0.0, 0.0, REST)]) for part in parts])


def _straight(model: PointModel, speed: float) -> FloatArray:
    far = REACH - 0.01
    out, back = _way(model, far, 0.0, speed), _way(model, -far, 0.0, speed)
    return _rested(out, np.vstack([back, back]), out)


def _straights(model: PointModel) -> FloatArray:
    return np.vstack([_straight(model, speed) for speed in (FAST, MIDDLE, SLOW)])


def _turns(model: PointModel, speed: float) -> FloatArray:
    return _rested(*(_way(model, 0.0, side * TURN, speed) for side in (1.0, -1.0)))


def _spins(model: PointModel) -> FloatArray:
    return np.vstack([_turns(model, speed) for speed in (FAST, SLOW)])


def _steps(model: PointModel) -> FloatArray:
    pairs = ((FAST, FAST), (MIDDLE, -MIDDLE), (FAST, SLOW), (SLOW, FAST), (0.0, FAST), (FAST, 0.0))
    parts = []
    for left, right in pairs:
        there, back = _hold(left, right, 0.6), _hold(-left, -right, 0.6)
        parts += [there, back, _hold(0.0, 0.0, 0.4)]
    return np.vstack(parts)


def _square(model: PointModel) -> FloatArray:
    side = 0.09  # m; its diagonal stays within reach
    parts = []
    for way in (1.0, -1.0):
        for _ in range(4):
            parts += [_way(model, side, 0.0, FAST), _way(model, 0.0, way * TURN / 4.0, MIDDLE)]
    return _rested(*parts)


def _ramp(model: PointModel) -> FloatArray:
    parts = []
    for speed, seconds in ((SLOW, 5.0), (FAST, 1.9)):
        out, back = _rise(speed, speed, seconds), _rise(-speed, -speed, seconds)
        parts += [out, back, back, out]
    for side in (1.0, -1.0):
        parts.append(_rise(-side * SLOW, side * SLOW, 5.0))
    return _rested(*parts)


def _circle(model: PointModel) -> FloatArray:
    out, back = (_way(model, way * TURN * 0.06, way * TURN, MIDDLE) for way in (1.0, -1.0))
    return _rested(out, back)


def _figure_eight(model: PointModel) -> FloatArray:
    left, right = (_way(model, TURN * 0.06, side * TURN, MIDDLE) for side in (1.0, -1.0))
    return _rested(left, right)


def _in_formation(name: str, wheels: Callable[[PointModel], FloatArray]) -> Callable[..., Lap]:
    """A lap that all robots do alike."""

    def lap(number: int, robots: int, model: PointModel) -> Lap:
        room = model.arena_radius - model.body_radius - MARGIN - REACH
        places = _lattice(room)
        _check(name, robots, len(places))
        homes = np.column_stack([places[:robots], np.full(robots, GOLDEN * number % TURN)])
        return Lap(homes, np.repeat(wheels(model)[:, None], robots, axis=1))

    return lap


def _lattice(room: float) -> FloatArray:
    """(places, 2) of a hexagonal lattice within a radius (m), from the middle outwards."""
    reach = int(room / SPACING) + 1
    i, j = np.mgrid[-reach : reach + 1, -2 * reach : 2 * reach + 1].reshape(2, -1)
    x, y = SPACING * (j + 0.5 * i), SPACING * math.sqrt(0.75) * i
    radius = np.round(np.hypot(x, y), 9)
    order = np.lexsort((np.arctan2(y, x), radius))
    inside = order[radius[order] <= room]
    return np.column_stack([x[inside], y[inside]])


def _tour(name: str) -> Callable[..., Lap]:
    """Round along the wall, turning and going in and out at every stop."""

    def lap(number: int, robots: int, model: PointModel) -> Lap:
        radius = model.arena_radius - TOUR_GAP
        _check(name, robots, int(TURN * radius / SPACING))
        angle = TURN * np.arange(robots) / robots + TOUR_STEP * number
        homes = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), angle + math.pi])
        wheels = _rested(
            _way(model, 0.0, TURN, MIDDLE),
            _way(model, 0.2, 0.0, FAST),
            _way(model, 0.0, -TURN, MIDDLE),
            _way(model, -0.2, 0.0, FAST),
        )
        return Lap(homes, np.repeat(wheels[:, None], robots, axis=1))

    return lap


def _pairs(number: int, robots: int, model: PointModel) -> Lap:
    """Robots approach and turn before one another, and in every other lap before the wall."""
    radius = model.arena_radius - model.body_radius - TOUR_GAP
    pairs = (robots + 1) // 2
    _check("face-to-face", robots, 2 * int(TURN * radius / (2.0 * APART + SPACING)))
    angle = TURN * np.arange(pairs) / pairs
    middle = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    aside = APART * np.column_stack([-np.sin(angle), np.cos(angle)])
    places = np.stack([middle - aside, middle + aside], axis=1).reshape(-1, 2)
    each = np.repeat(angle, 2)
    facing = each + np.tile([0.5 * math.pi, -0.5 * math.pi], pairs)
    outward = np.arctan2(places[:, 1], places[:, 0])
    yaw = facing if number % 2 == 0 else outward
    near = 0.05  # m; leaves 30 mm between two robots and a little more to the wall
    wheels = _rested(
        _way(model, near, 0.0, SLOW),
        _way(model, 0.0, TURN, SLOW),
        _way(model, 0.0, -TURN, SLOW),
        _way(model, -near, 0.0, SLOW),
    )
    homes = np.column_stack([places, yaw])[:robots]
    return Lap(homes, np.repeat(wheels[:, None], robots, axis=1))


def _alone(number: int, robots: int, model: PointModel) -> Lap:
    """One robot after the other works in the middle while the others wait along the wall."""
    radius = model.arena_radius - model.body_radius - MARGIN
    _check("alone", robots, int(TURN * radius / SPACING))
    angle = TURN * np.arange(robots) / robots
    homes = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), angle + math.pi])
    turn, working = divmod(number, 2)
    if not working:  # nobody comes in before the one before is out
        return Lap(homes, np.zeros((1, robots, 2)))
    worker = turn % robots
    homes[worker] = 0.0, 0.0, GOLDEN * turn
    own = np.vstack([_steps(model), _turns(model, FAST), _straight(model, FAST)])
    wheels = np.zeros((len(own), robots, 2))
    wheels[:, worker] = own
    return Lap(homes, wheels)


def _check(name: str, robots: int, most: int) -> None:
    if robots > most:
        raise InputError("--robots", robots, f"at most {most} for {PREFIX}{name} in this arena")


_FORMATIONS = {
    "straights": ("straights forwards and backwards at three speeds", _straights),
    "spins": ("full turns on the spot both ways, fast and slowly", _spins),
    "steps": ("steps of speed: starts, stops and reversals, straight and turning", _steps),
    "square": ("squares both ways", _square),
    "slow-ramp": ("speed that rises slowly from rest and falls again", _ramp),
    "circle": ("circles to the left of the robot, forwards and backwards", _circle),
    "figure-eight": ("circles to the left and to the right in turn", _figure_eight),
}

MENU: Mapping[str, Probe] = {
    one.name: one
    for one in (
        *(
            Probe(name=name, does=does, lap=_in_formation(name, wheels), formation=True)
            for name, (does, wheels) in _FORMATIONS.items()
        ),
        Probe(
            name="tour",
            does="a round along the wall, near to the lamp and far from it, turning and crossing "
            "the nest's edge",
            lap=_tour("tour"),
            walled=True,
        ),
        Probe(
            name="dark-tour",
            does="the same round with the lamp switched off",
            lap=_tour("dark-tour"),
            dark=True,
            walled=True,
        ),
        Probe(
            name="face-to-face",
            does="two robots turn before one another, then before the wall",
            lap=_pairs,
            walled=True,
            least=2,
        ),
        Probe(
            name="alone",
            does="one robot after the other does steps, spins and straights in the middle while "
            "the others wait",
            lap=_alone,
        ),
    )
}
"""By name, in the order they are shown."""
