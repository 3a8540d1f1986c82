"""Where one frame is in another, from the links between frames that were sent one by one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray

Link = tuple[str, str]
"""Parent and child frame."""


def chain(links: Mapping[Link, object], frame: str, within: str, field: str) -> list[Link]:
    """The links from an outer frame to an inner one, outermost first.

    Raises:
        InputError: they do not lead there.
    """
    parents = {child: parent for parent, child in links}
    path: list[Link] = []
    at = frame
    while at != within and at in parents and len(path) <= len(links):
        path.insert(0, (parents[at], at))
        at = parents[at]
    if at != within or not path:
        listed = ", ".join(f"{parent} > {child}" for parent, child in sorted(links))
        raise InputError(field, f"no way from {within} to {frame}", f"frames among {listed}")
    return path


def composed(parts: list[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Times and poses of the innermost frame of a chain in its outermost.

    Every link holds until it is sent again; a pose stands at each time the innermost link that
    moves was sent.

    Args:
        parts: Per link, outermost first, its times (n,) in s, increasing, and its poses (n, 7): x,
            y, z and a quaternion.

    Returns:
        (n,) s and (n, 7) poses.
    """
    from scipy.spatial.transform import Rotation  # a tenth of a second, and few logs have frames

    moving = [times for times, _ in parts if len(times) > 1]
    when = moving[-1] if moving else parts[-1][0]
    begun = max((times[0] for times in moving), default=-np.inf)
    when = when[when >= begun]
    place, turn = np.zeros((len(when), 3)), Rotation.identity(len(when))
    for times, poses in parts:
        at = np.maximum(np.searchsorted(times, when, side="right") - 1, 0)
        own = poses[at]
        place = place + turn.apply(own[:, :3])
        turn = turn * Rotation.from_quat(own[:, 3:])
    return when, np.column_stack([place, turn.as_quat()])
