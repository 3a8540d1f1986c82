"""The evidence for a cause in the senses, in its own channel: counts, their scatter, the nest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from realitygap.embedded_sim import SENSORS, PointModel, Tables
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.extended import as_written
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.channels.senses.joined import WholeExamination
from realitygap.models.naming.channels.senses.nest import Answers
from realitygap.models.naming.channels.senses.predicted import TELLING, noise, predict
from realitygap.models.naming.channels.senses.sight import Rows, Sight
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.findings import Named
from realitygap.studies.diagnosis.tracks import COLOURS
from realitygap.studies.pages.drawing import HALF, canvas, save

STRIP = 20.0
"""s of readings that are drawn; our choice."""
CHANNELS = {"ps": "infrared", "ls": "light"}
COUNTS = (
    "{who}, {channel} sensor {sensor}: what it read and what was predicted of it, in counts, in "
    "the {seconds:g} s in which the model was furthest off."
)
BY_SENSOR = (
    "{who}: mean error of every {channel} sensor in counts, over readings that only wall and lamp "
    "can have caused."
)
SCATTER = (
    "Errors of infrared of {who}, in standard deviations of the captured noise. The line is what "
    "captured sensors would do."
)
NEST = "Where {who} was when the virtual sensor said nest (dots), and the nest's edge."


class SenseEvidence:
    """What the senses of a diagnosis read, and what is predicted of them."""

    def __init__(self, examined: WholeExamination, tables: Tables | None) -> None:
        self.examined, self.senses = examined, examined.senses
        self.before = examined.model
        named = [written(one, one.values) for one in examined.diagnosis.named]
        self.after = as_written(self.before, named)
        plain = self.before.model_copy(update={"extension": None})
        self.point: PointModel = plain.point_model(tables)
        sight = self.senses.sight
        self.told: dict[str, FloatArray] = {}
        if sight is not None:
            for name, file in (("predicted", self.before), ("corrected", self.after)):
                self.told[name] = predict(sight, self.point, self.beliefs(file, sight))

    def beliefs(self, file: ModelFile, sight: Sight) -> list[Belief]:
        """What a file has each robot believe."""
        if file.extension is None:
            return [Belief(senses=self.point.senses)] * len(sight.robots)
        return [file.extension.sensed(robot) for robot in sight.robots]

    def draw(self, one: Named, stem: Path) -> list[tuple[Path, str]]:
        """Pictures of the evidence for a cause of the senses, with their captions.

        Args:
            one: The cause.
            stem: Beginning of the pictures' names.
        """
        cause, seen = one.term.cause, self.senses.answers
        assert isinstance(cause, SenseCause)
        if cause.kind == "nest" and seen is not None:
            return [self._nest(one, seen, Path(f"{stem}-nest.png"))]
        sight = self.senses.sight
        if sight is None:
            return []
        if cause.kind == "noise":
            return [self._scatter(one, sight, Path(f"{stem}-scatter.png"))]
        kinds = {"ls": ("ls",), "ps": ("ps",)}.get(cause.kind, ("ps", "ls"))
        drawn = (self.counts(one.robots, kind, one.term.variant, stem) for kind in kinds)
        return next((pictures for pictures in drawn if pictures), [])

    def counts(
        self, concerned: Sequence[int], kind: str, word: str, stem: Path
    ) -> list[tuple[Path, str]]:
        """The strip of one sensor, where it tells most, and the mean errors of all eight.

        Args:
            concerned: Ids of robots.
            kind: ps or ls.
            word: Number of the sensor; anything else: the one that tells most.
            stem: Beginning of the pictures' names.
        """
        sight = self.senses.sight
        assert sight is not None
        half = slice(0, SENSORS) if kind == "ps" else slice(SENSORS, 2 * SENSORS)
        read = sight.read[:, half]
        use = sight.free[:, half] & np.isfinite(read)
        robots = [k for k, robot in enumerate(sight.robots) if robot in concerned]
        if not robots or not any(use[sight.rows_of(k)].any() for k in robots):
            return []
        told = {n: t[:, half] for n, t in self.told.items()}
        if np.array_equal(told["predicted"], told["corrected"]):
            del told["corrected"]
        error = {n: np.where(use, np.abs(read - t), np.nan) for n, t in told.items()}
        less = np.nan_to_num(error["predicted"] - error.get("corrected", 0.0))
        total = np.array([less[sight.rows_of(k)].sum(axis=0) for k in robots])
        if word.isdigit():
            total[:, np.arange(SENSORS) != int(word)] = -np.inf
        at, sensor = (int(k) for k in np.unravel_index(int(np.argmax(total)), total.shape))
        robot = robots[at]
        rows = np.arange(*sight.begin[robot : robot + 2])
        words = {
            "who": f"Robot {self.examined.diagnosis.names[sight.robots[robot]]}",
            "channel": CHANNELS[kind],
            "sensor": sensor,
        }
        strip = _worst_strip(sight, rows, less[rows, sensor])
        figure, axes = _figure()
        since = sight.time[strip]
        axes.plot(since, read[strip, sensor], ".", color=COLOURS["measured"], label="measured")
        for name, style in zip(told, ("--", "-"), strict=False):
            line = told[name][strip, sensor]
            axes.plot(since, line, style, color=COLOURS[name], label=name)
        axes.set(xlabel="time (s)", ylabel=f"{words['channel']} {kind}{sensor} (counts)")
        axes.legend(fontsize=8)
        first = Path(f"{stem}-strip.png")
        save(figure, first)
        second = Path(f"{stem}-sensors.png")
        _bars({n: _mean(e[rows]) for n, e in error.items()}, kind, second)
        seconds = float(np.ptp(since))
        return [
            (first, COUNTS.format(**words, seconds=round(seconds))),
            (second, BY_SENSOR.format(**words)),
        ]

    def _scatter(self, one: Named, sight: Sight, path: Path) -> tuple[Path, str]:
        """How infrared scatters about what is predicted."""
        expected = self.told["predicted"]
        width = noise(sight, self.point, self.beliefs(self.before, sight), expected)
        strong = sight.free & np.isfinite(sight.read) & (expected > TELLING)
        strong[:, SENSORS:] = False
        mine = np.isin(sight.robot, [k for k, r in enumerate(sight.robots) if r in one.robots])
        figure, axes = _figure()
        edges = np.linspace(-6.0, 6.0, 49).tolist()
        z = (sight.read - expected) / width
        axes.hist(z[strong & mine[:, None]], edges, density=True, color="#9db4c8", label="measured")
        middle = np.linspace(-6.0, 6.0, 200)
        normal = np.exp(-0.5 * middle**2) / np.sqrt(2.0 * np.pi)
        axes.plot(middle, normal, color=COLOURS["predicted"], label="as captured")
        axes.set(xlabel="error (standard deviations of captured noise)", ylabel="density")
        axes.legend(fontsize=8)
        save(figure, path)
        return path, SCATTER.format(who=_who(self.examined, one))

    def _nest(self, one: Named, seen: Answers, path: Path) -> tuple[Path, str]:
        """Where the virtual sensor said nest, with the believed edge and the one found."""
        mine = np.isin(seen.robot, one.robots)
        figure, axes = _figure()
        for inside, colour, size in ((False, "#d0d0d0", 1.0), (True, COLOURS["measured"], 3.0)):
            dots = seen.place[mine & (seen.inside == inside)]
            axes.plot(*dots.T, ".", color=colour, markersize=size)
        for name, file in (("predicted", self.before), ("corrected", self.after)):
            extension, robot = file.extension, one.robots[0]
            belief = Belief() if extension is None else extension.sensed(robot)
            x, y, radius = replace(belief, senses=self.point.senses).of(self.point).nest
            style = {"color": COLOURS[name], "label": name, "fill": False, "linewidth": 1.6}
            axes.add_patch(Circle((x, y), radius, **style))
        axes.set(xlabel="x (m)", ylabel="y (m)")
        axes.set_aspect("equal", adjustable="datalim")
        axes.legend(fontsize=8)
        save(figure, path)
        return path, NEST.format(who=_who(self.examined, one))


def _who(examined: WholeExamination, one: Named) -> str:
    names = examined.diagnosis.names
    if one.whole_swarm:
        return "every robot"
    return " and ".join(f"robot {names[robot]}" for robot in one.robots)


def _worst_strip(sight: Sight, rows: Rows, less: FloatArray) -> Rows:
    """Rows of the stretch of a robot's run in which a correction takes off most."""
    key = sight.run[rows] * 10**6 + (sight.time[rows] / STRIP).astype(np.int64)
    keys, at = np.unique(key, return_inverse=True)
    best = int(np.argmax(np.bincount(at, less, len(keys))))
    return np.asarray(rows[at == best])


def _mean(errors: FloatArray) -> FloatArray:
    """(8,) means over the readings that are judged; 0 where there is none."""
    seen = np.isfinite(errors)
    return np.asarray(np.nansum(errors, axis=0) / np.maximum(seen.sum(axis=0), 1))


def _bars(errors: dict[str, FloatArray], kind: str, path: Path) -> None:
    figure, axes = _figure()
    at = np.arange(SENSORS)
    for side, (name, values) in zip((-0.2, 0.2), errors.items(), strict=False):
        axes.bar(at + side, values, 0.38, color=COLOURS[name], label=name)
    axes.set_xticks(at, list(PS if kind == "ps" else LS))
    axes.set(ylabel="mean error (counts)")
    axes.legend(fontsize=8)
    save(figure, path)


def _figure() -> tuple[Figure, Axes]:
    figure = canvas(HALF, 3.4)
    return figure, figure.subplots()
