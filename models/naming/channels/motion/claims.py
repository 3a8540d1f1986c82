"""What may be said of motion: which names are exported, what that gains, what could be unseen.

Between what was found in a log and what is claimed of it stand four questions. Does a value end at
a bound of the catalogue? Does the model with a cause predict better where it was not fitted? Is
the error of a robot without any finding no larger than a healthy robot's? And would the log have
shown a fault at all?
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.conditions import conditions
from realitygap.models.gap.replay import HORIZONS
from realitygap.models.log.blocks import interval
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.channels.motion.detectable import Seen, detectable, untold
from realitygap.models.naming.channels.motion.examination import KINDS, Examination
from realitygap.models.naming.channels.motion.fitted import Values, refitted
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.claims.ahead import HORIZON_OF, KEYS, SECONDS, Ahead, key, together
from realitygap.models.naming.claims.harm import Predictions, harmless, robots_of
from realitygap.models.naming.claims.written import at_bound
from realitygap.models.naming.diagnosis import Detectable, Gain, Unexplained
from realitygap.models.naming.findings import SURE, Named
from realitygap.models.naming.health.reference import Reference
from realitygap.models.naming.rules import Rules


def claimed(
    examined: Examination, log: MeasuredLog, table: pd.DataFrame | None = None, *, seed: int = 0
) -> Examination:
    """The examination with what its diagnosis may claim of motion.

    Args:
        examined: Whose diagnosis holds what was named and what is left.
        log: Of which.
        table: The log's conditions; None: they are looked up.
        seed: Of the draws of noise and of the resampling.
    """
    found, tracks, said = examined.identified, examined.tracks, examined.diagnosis
    inside, ended = bounded(said.named)
    ahead = Ahead(log, conditions(log, examined.model) if table is None else table)
    by_part: tuple[Values, ...] = (
        {**refitted(found.fits, 0), **found.by_part[0]},
        {**refitted(found.fits, 1), **found.by_part[1]},
    )
    predictions = Predictions(ahead, examined.model, inside, by_part)
    refused = harmless(predictions, tracks.rules)
    refused = _as_a_whole(ahead, examined.model, inside, refused, tracks.rules)
    named = tuple(
        replace(one, exported=k not in refused, why=refused.get(k, ""))
        for k, one in enumerate(inside)
    )
    base = dict(zip(tracks.robots, found.base, strict=True))
    rng = np.random.default_rng(seed)
    errors = _Errors(predictions, examined.reference, tracks, base, found.alike, rng)
    exported = frozenset(range(len(named))) - refused.keys()
    unexplained = (*said.unexplained, *ended)
    seen = detectable(found.least, found.explained)
    diagnosis = replace(
        said,
        named=named,
        unexplained=(*unexplained, *errors.far(named, unexplained)),
        gain=errors.gains(named, exported),
        detectable=tuple(_told(one, tracks.robots) for one in seen),
        untold=untold(seen, tracks.robots, tracks.rules),
        used=tracks.used,
    )
    return replace(examined, diagnosis=diagnosis, errors=errors.by_robot(exported))


def _as_a_whole(
    ahead: Ahead,
    model: ModelFile,
    named: Sequence[Named],
    refused: Mapping[int, str],
    rules: Rules,
) -> dict[int, str]:
    """What is refused, and what harms with the values that would be exported.

    Those are of the whole log, and were fitted beside what follows a quantity, which is not
    exported: in a log that always does the same they may stand for something else.
    """
    kept = [k for k in range(len(named)) if k not in refused]
    if not kept:
        return dict(refused)
    values = {named[k].key: named[k].values for k in kept}
    whole = Predictions(ahead, model, [named[k] for k in kept], (values, values))
    return {**refused, **{kept[k]: why for k, why in harmless(whole, rules).items()}}


def bounded(named: Sequence[Named]) -> tuple[tuple[Named, ...], tuple[Unexplained, ...]]:
    """Names whose values lie inside their bounds, and the others as unexplained."""
    inside, ended = [], []
    for one in named:
        found = at_bound(one)
        if found is None:
            inside.append(one)
            continue
        parameter, bound = found
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        cause = one.term.cause
        several = f" ({parameter.name})" if len(cause.parameters) > 1 else ""
        ended.append(
            Unexplained(
                channel=CHANNELS.get(getattr(cause, "kind", ""), "motion"),
                share=one.evidence.share,
                where=f"{cause.name} at its bound of {bound:g}{unit}{several}",
                quantity="bound",
                robots="all" if one.whole_swarm else one.robots,
                distance=min(one.evidence.distance, SURE),  # an end may have no error
            )
        )
    return tuple(inside), tuple(ended)


CHANNELS = {
    "ps": "infrared",
    "ls": "light",
    "both": "infrared",
    "noise": "infrared",
    "nest": "nest",
}
"""Channel in which a cause in the senses shows, by its kind; of any other it is `motion`."""


def _told(one: Seen, robots: Sequence[int]) -> Detectable:
    """Of the robot in which it would have been seen worst."""
    parameter = one.cause.parameters[0]
    limit = not np.isfinite(parameter.null)
    unseen = np.isnan(one.size)
    size = np.where(unseen, np.inf, -one.size if limit else one.size)
    worst = int(np.argmax(size))
    return Detectable(
        cause=one.cause.name,
        parameter=parameter.name,
        unit=parameter.unit,
        null=None if limit else parameter.null,
        size=None if unseen[worst] else float(one.size[worst]),
        robot=robots[worst],
    )


Ratio = tuple[float, str, float, float]
"""How many times an error is what tracker noise leaves, its key, and both."""


class _Errors:
    """Predictions weighed against what healthy robots leave."""

    def __init__(
        self,
        predictions: Predictions,
        reference: Reference,
        tracks: Tracks,
        base: Mapping[int, Motion],
        alike: bool,
        rng: np.random.Generator,
    ) -> None:
        self.predictions, self.reference, self.tracks = predictions, reference, tracks
        self.base, self.alike, self.rng = base, alike, rng
        self._gate = reference.gates.under(tracks.rules).error
        self.ahead, self.model = predictions.ahead, predictions.model
        plain = self.model.model_copy(update={"extension": None})
        self._minimal = plain.motion()
        self._healthy = reference.motion(self._minimal)
        self._sounds: dict[int, dict[str, FloatArray]] = {}

    def _sound(self, robot: int) -> dict[str, FloatArray]:
        """By key, what the minimal model would be off of a healthy robot under one's commands."""
        if robot not in self._sounds:
            minimal = self.ahead.replay(robot, lambda r, part: self._minimal)
            healthy = self.ahead.replay(robot, lambda r, part: self._healthy)
            noise = self.tracks.noise
            self._sounds[robot] = self.ahead.sound(robot, minimal, healthy, noise, self.rng)
        return self._sounds[robot]

    def by_robot(self, exported: frozenset[int]) -> pd.DataFrame:
        """As `Examination.errors`."""
        rows = []
        for robot in self.tracks.robots:
            sizes = self.predictions.sizes
            found = [sizes(robot, frozenset()), self._sound(robot), sizes(robot, exported)]
            for kind, one in zip(KINDS, found, strict=True):
                if kind == KINDS[1] and not self.reference.robots:
                    continue
                for horizon in SECONDS:
                    error = one[key("position", horizon)]
                    if len(error):
                        rows.append((robot, HORIZONS[horizon], kind, float(error.mean())))
        return pd.DataFrame(rows, columns=["robot", "seconds", "kind", "error"])

    def gains(self, named: Sequence[Named], exported: frozenset[int]) -> dict[str, Gain]:
        """By key, mean errors over the robots whose causes are exported, or over all."""
        robots = robots_of([named[k] for k in sorted(exported)], self.tracks.robots)
        sizes = self.predictions.sizes
        before = [sizes(robot, frozenset()) for robot in robots]
        after = [sizes(robot, exported) for robot in robots]
        sound = [self._sound(robot) for robot in robots]
        found = {}
        for name, unit in KEYS.items():
            less, more = together(before, name), together(after, name)
            if not len(less):
                continue
            low, high = interval(more, self.ahead.block(name, robots), self.rng)
            known = self.reference.robots > 0
            found[name] = Gain(
                before=float(less.mean()),
                after=float(more.mean()),
                low=low,
                high=high,
                healthy=float(together(sound, name).mean()) if known else None,
                unit=unit,
            )
        return found

    def far(self, named: Sequence[Named], left: Sequence[Unexplained]) -> tuple[Unexplained, ...]:
        """Robots without any finding whose error is far above what healthy robots leave."""
        if any(one.robots == "all" for one in left):
            return ()
        told = {r for one in named for r in one.robots}
        told |= {r for one in left if one.robots != "all" for r in one.robots}
        known = [robot for robot in self.tracks.robots if not self.alike or robot not in told]
        ratios = {robot: self._ratios(robot) for robot in known}
        usual = {} if self.alike else _usual(list(ratios.values()), self.tracks.rules)
        found = []
        for robot in known:
            one = self._far(robot, ratios[robot], usual) if robot not in told else None
            if one is not None:
                found.append(one)
        return tuple(found)

    def farthest(self) -> float:
        """Largest of the robots' errors, times what tracker noise alone would leave."""
        each = [self._ratios(robot) for robot in self.tracks.robots]
        return max((far for own in each for far, *_ in own), default=0.0)

    def _far(
        self, robot: int, ratios: Sequence[Ratio], usual: Mapping[str, float]
    ) -> Unexplained | None:
        """At the horizon at which it is farthest."""
        beyond = [one for one in ratios if one[0] > self._gate * usual.get(one[1], 1.0)]
        if not beyond:
            return None
        most, name, seen, noise = max(beyond)
        unit = KEYS[name]
        what = "position" if name.startswith("position") else "heading"
        size = f"{1e3 * seen:.0f} mm" if unit == "m" else f"{seen:.2g} rad"
        seconds = HORIZONS[HORIZON_OF[name]]
        return Unexplained(
            channel="motion",
            share=1.0 - (noise / seen) ** 2,
            where=f"its predicted {what} is off by {size} after {seconds:g} s, {most:.0f} times "
            "what a healthy robot would show",
            quantity="error",
            robots=(robot,),
            distance=most,
        )

    def _ratios(self, robot: int) -> list[Ratio]:
        """By key, how often the error that tracker noise leaves of a healthy robot is in the median
        error by the healthy model, with the key and both."""
        path = self.ahead.replay(robot, lambda r, part: self.base[robot])
        off = self.ahead.sizes(robot, path)
        noise = self.ahead.sound(robot, path, path, self.tracks.noise, self.rng)
        found = []
        for name in KEYS:
            some = self.ahead.apart(name, robot)
            if len(some) < self.tracks.rules.least_apart:
                continue
            seen, usual = float(np.median(off[name][some])), float(np.median(noise[name][some]))
            if usual > 0.0:
                found.append((seen / usual, name, seen, usual))
        return found


def _usual(every: Sequence[Sequence[Ratio]], rules: Rules) -> dict[str, float]:
    """By key, the median robot's ratio, at least 1: what most have may be the recording's.

    Of fewer than make a swarm nobody says which one differs.
    """
    if len(every) < rules.least_swarm:
        return {}
    found: dict[str, list[float]] = {}
    for own in every:
        for ratio, name, *_ in own:
            found.setdefault(name, []).append(ratio)
    return {name: max(1.0, float(np.median(each))) for name, each in found.items()}


def farthest_error(
    log: MeasuredLog, model: ModelFile, reference: Reference, tracks: Tracks, *, seed: int = 0
) -> float:
    """Largest error of healthy robots by the healthy model, times what tracker noise leaves."""
    ahead = Ahead(log, conditions(log, model))
    predictions = Predictions(ahead, model, (), ({}, {}))
    base = {robot: reference.motion(model.motion(robot)) for robot in tracks.robots}
    rng = np.random.default_rng(seed)
    return _Errors(predictions, reference, tracks, base, True, rng).farthest()
