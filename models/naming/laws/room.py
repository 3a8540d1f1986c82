"""What is known of a log when laws are asked for: its robots with their causes, and health."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.laws import Law
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.noise import learn
from realitygap.models.naming.channels.motion.predict import poses
from realitygap.models.naming.channels.motion.robot import Robot
from realitygap.models.naming.engine.marginal import EMPTY, Prior, root_of
from realitygap.models.naming.engine.state import SWARM, State, with_kept
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Named

FREE = 1e4
"""Variance that is as good as free, over a column's own. No rule: a tolerance."""


class LawRoom:
    """What is known of a log when laws are asked for: its robots with their causes, and health."""

    def __init__(self, state: State, named: Sequence[Named]) -> None:
        """Prepare.

        Args:
            state: Of the engine at its end.
            named: Causes that stand; what else was fitted is taken back.
        """
        said = {
            (SWARM if one.whole_swarm else state.tracks.robots.index(robot), one.evidence.term.key)
            for one in named
            for robot in one.robots
        }
        for scope in (SWARM, *range(len(state.robots))):
            causes = [
                one
                for one in state.of(scope)
                if one.item.term is not None and (scope, one.item.key) in said
            ]
            state = with_kept(state, scope, causes)
        self.state, self._weighed = state, Weighed(state)
        self.robots = [one for one in state.robots if isinstance(one, Robot)]
        self.seconds = max(float(np.ptp(state.tracks.t)), 1.0)

    def prior(self, k: int, *, shared: bool) -> Prior:
        """What is believed of a robot's coefficients, `shared`: by itself, not beside its swarm."""
        weighed = self._weighed
        prior = weighed.prior_of(k) if shared else weighed.prior_beside(k)
        own = prior.root @ prior.root.T
        if shared:
            own = own + np.diag(weighed.unfitted[prior.at] ** 2)
        robot = self.state.robots[k]
        free = np.zeros(len(prior.at))
        for scope in (SWARM, k):
            for one in self.state.of(scope):
                for i, column in enumerate(prior.at):
                    if robot.names[column].partition(".")[0] == one.item.of.key:
                        free[i] = FREE / max(robot.information[column, column], EMPTY)
        return prior._replace(root=root_of(own + np.diag(free)))


def obeying(robot: Robot, law: Law) -> Robot:
    """The robot with one more law in its motion, its columns and its noise as they were."""
    motion = robot.motion
    laws = (*motion.drive.laws, law)
    moved = replace(motion, drive=replace(motion.drive, laws=laws, body=robot.tracks.body))
    errors = Problem(robot.tracks, [moved]).fitter(poses(robot.tracks, [moved]))
    return Robot(robot.tracks, moved, replace(robot.made, errors=errors), robot.noise)


def relearned(robot: Robot, columns: FloatArray) -> Robot:
    """The robot, its noise learned with (n, 3, q) more columns free."""
    made = robot.made
    wide = replace(
        made,
        values=np.concatenate([made.values, columns], axis=2),
        names=(*made.names, *(f"law {k}" for k in range(columns.shape[2]))),
    )
    (noise,) = learn([robot.tracks], [wide], robot.tracks.rules)
    return Robot(robot.tracks, robot.motion, made, noise)
