"""Infrared or light of one robot as rows of the mixed model: errors, columns, windows.

A row is one reading that nothing but wall and lamp can have caused. Readings of a second are one
window, which has a little of its own: the share and the counts by which the captured tables are off
there, and where the averaged pose lies.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.log.blocks import nth
from realitygap.models.naming.channels.senses.predicted import noise, own_noise, told
from realitygap.models.naming.channels.senses.quantities import Key, of_readings, of_rows
from realitygap.models.naming.channels.senses.sight import (
    NEAREST_LAMP,
    Bools,
    Rows,
    Sight,
    too_near,
)

SPACING = {"infrared": 0.5, "light": 0.08}
"""s between the readings used where they change slowly: of infrared that sees nothing, and of all
light, whose errors are the tables' and not noise. Our choice. No rule: it bounds the work."""
NOTHING = 1.0
"""counts below which infrared sees nothing: half of the noise of such a reading. No rule: of the
sensor."""
LEAST_SHIFT = 1e-4
"""m and rad by which poses are shifted at least to see what that does. No rule: of numerics."""
CHANGES = {"share": "by a share of what they read", "counts": "by counts"}
"""How readings may follow a quantity."""
SWINGS = ("light", "share")
"""Where swings in time are looked for, for lamps flicker; single places only as a share."""
KINDS = {"infrared": ("ps", "both"), "light": ("ls", "both")}
"""Kinds of causes that a channel shows."""
RUN_APART = 1e6
"""s that is longer than any run. No rule: as good as infinite."""
REMEMBERED = 12
"""Beliefs whose counts are kept, the last ones asked for: what is believed now is asked for again
and again. No rule: of memory."""


class Eye:
    """One robot's rows of a log, and what it would read if something is believed."""

    def __init__(self, sight: Sight, model: PointModel) -> None:
        self.sight, self.model = sight, model
        self._kept: dict[Belief, FloatArray] = {}

    def counts(self, belief: Belief) -> FloatArray:
        """(rows, 16)."""
        found = self._kept.pop(belief, None)
        self._kept[belief] = self._read(self.sight, belief) if found is None else found
        if len(self._kept) > REMEMBERED:
            self._kept.pop(next(iter(self._kept)))
        return self._kept[belief]

    def slopes(self, belief: Belief) -> FloatArray:
        """(rows, 16, 3) change of the counts per m, m, rad of the pose."""
        here, found = self.counts(belief), []
        for axis in range(3):
            poses = self.sight.poses.copy()
            shift = np.maximum(self.sight.spread[:, axis], LEAST_SHIFT)
            poses[:, axis] += shift
            there = self._read(replace(self.sight, poses=poses), belief)
            found.append((there - here) / shift[:, None])
        return np.stack(found, axis=2)

    def _read(self, sight: Sight, belief: Belief) -> FloatArray:
        return told(sight, self.model, belief, np.arange(len(sight.time)))

    def usable(self, belief: Belief) -> Bools:
        """(rows, 16) readings that say something of wall and lamps, wherever these are believed."""
        use = self.sight.free.copy()
        for mine, lamp in self._elsewhere(belief):
            poses = self.sight.poses[mine]
            shaded = self.sight.neighbours.only(mine).before_lamp(poses, lamp, self.model)
            use[mine, SENSORS:] &= ~(too_near(poses, lamp)[:, None] | shaded)
        for memory in belief.memory:
            use &= self._since_hidden() > np.repeat(memory.reach, SENSORS)
        return use

    def _since_hidden(self) -> FloatArray:
        """(rows, 16) s since a reading of the run may have been caused by something else."""
        clock = (self.sight.time + RUN_APART * self.sight.run)[:, None]
        hidden = np.where(self.sight.free, -np.inf, clock)
        return np.asarray(clock - np.maximum.accumulate(hidden, axis=0))

    def _elsewhere(self, belief: Belief) -> Iterator[tuple[Bools, tuple[float, float]]]:
        """Lamps believed to stand elsewhere than in the model, and (rows,) when they are lit."""
        if belief.senses.second_lamp:
            yield (
                np.ones(len(self.sight.time), dtype=np.bool_),
                belief.senses.second_lamp[:2],
            )
        dx, dy = belief.senses.lamp_shift
        for index, lamp in enumerate(self.model.lamps):
            mine = self.sight.scenario == index
            if lamp is not None and np.hypot(dx, dy) > NEAREST_LAMP and mine.any():
                yield mine, (lamp[0] + dx, lamp[1] + dy)


class ReadingRows:
    """One robot's readings of one channel, at what is believed of it."""

    axes = 1

    def __init__(self, eye: Eye, name: str, belief: Belief) -> None:
        self.eye, self.name, self.kinds = eye, name, KINDS[name]
        self._half = slice(0, SENSORS) if name == "infrared" else slice(SENSORS, 2 * SENSORS)
        sight, model = eye.sight, eye.model
        assert model.tables is not None
        counts = eye.counts(belief)
        use = eye.usable(belief)[:, self._half]
        spaced = np.diff(nth(sight.time, SPACING[name]), prepend=-1) != 0
        some = spaced[:, None]
        if name == "infrared":
            some = some | (counts[:, self._half] > NOTHING)
        self.row, self.sensor = np.nonzero(use & some)
        self._read, self._scale = self._picked(sight.read), belief.senses.ps_noise
        self.sd = self._picked(noise(sight, model, [belief], counts))
        self.slopes = self._picked(eye.slopes(belief)) / self.sd[:, None]
        own = own_noise(sight, model, [belief], counts)
        self.own = (self._picked(own) / self.sd) ** 2
        """(n,) share of the variance that is the sensors' own."""
        seen = counts - np.hstack([belief.senses.ps_offset, np.zeros(SENSORS)])
        reading = self._picked(seen)
        self.signal = reading if name == "infrared" else model.tables.ls_dark - reading
        window = nth(sight.time[self.row], sight.rules.window)
        key = sight.run[self.row] * (window.max(initial=0) + 1) + window
        self.window = np.unique(key, return_inverse=True)[1]
        self.first = np.flatnonzero(np.diff(self.window, prepend=-1))

    def _picked(self, readings: FloatArray) -> FloatArray:
        return readings[:, self._half][self.row, self.sensor]

    def errors(self, belief: Belief) -> FloatArray:
        """(n,) in noise if something is believed."""
        senses = replace(belief.senses, ps_noise=self._scale)  # of noise its scatter tells
        counts = self.eye.counts(replace(belief, senses=senses))
        return (self._read - self._picked(counts)) / self.sd

    @property
    def moments(self) -> Rows:
        """(windows,) first row of each window."""
        return self.row[self.first]

    def effects(self) -> FloatArray:
        """(n, q) columns of what each window may have of its own."""
        own = [self.signal / self.sd, 1.0 / self.sd]
        return np.column_stack([*own, self.slopes])

    def late(self) -> FloatArray:
        """(n,) errors per second by which poses are late."""
        return np.asarray((self.slopes * velocity(self.eye.sight)[self.row]).sum(axis=1))

    def flexible(self) -> Iterator[tuple[str, Key, FloatArray]]:
        """How readings change, the quantity and its function, and (n,) errors per unit of that.

        A quantity has mean 0 and standard deviation 1 as far as the readings can tell.
        """
        sight, model, light = self.eye.sight, self.eye.model, self.name == "light"
        signal = np.zeros((len(sight.time), SENSORS))
        signal[self.row, self.sensor] = self.signal
        values = {key: q[self.row] for key, q in of_rows(sight, model).items()}
        single = of_readings(sight, model, signal, light=light)
        values |= {key: q[self.row, self.sensor] for key, q in single.items()}
        sign = -1.0 if light else 1.0  # more light, fewer counts
        for change, per in (("share", sign * self.signal / self.sd), ("counts", sign / self.sd)):
            for key, q in values.items():
                if key[0] == "time" and key[1] and (self.name, change) != SWINGS:
                    continue
                if key[0] == "point" and change != SWINGS[1]:
                    continue
                plain = key[0] in ("always", "sensor")
                yield change, key, per * (q if plain else _standardised(q, per**2))


def _standardised(q: FloatArray, importance: FloatArray) -> FloatArray:
    weight = max(float(importance.sum()), 1e-9)
    centred = q - float((importance * q).sum()) / weight
    sd = float(np.sqrt((importance * centred**2).sum() / weight))
    return centred / sd if sd > 1e-6 else np.zeros_like(centred)


def velocity(sight: Sight) -> FloatArray:
    """(rows, 3) m/s, m/s, rad/s of one robot as measured, over the rows beside; 0 at the ends of
    its runs."""
    ahead, back = np.roll(sight.poses, -1, axis=0), np.roll(sight.poses, 1, axis=0)
    moved = ahead - back
    moved[:, 2] = (moved[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    took = np.roll(sight.time, -1) - np.roll(sight.time, 1)
    usual = float(np.median(took)) if len(took) else 1.0
    inside = (took > 0.5 * usual) & (took < 1.5 * usual)
    inside &= (np.roll(sight.run, -1) == sight.run) & (np.roll(sight.run, 1) == sight.run)
    return np.asarray(np.where(inside[:, None], moved / np.where(inside, took, 1.0)[:, None], 0.0))
