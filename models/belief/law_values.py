"""What an atom of a law is worth, given the quantities that it is of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from realitygap.embedded_sim.laws import Atom
from realitygap.embedded_sim.model import FloatArray

SPEEDS = ("wheel_speed", "speed", "turn")
"""Quantities with a direction; thresholds are of their size."""
Known = Mapping[str, FloatArray]
"""By quantity, (n,) numbers; `place` (n, 2)."""


def value(atom: Atom, known: Known) -> FloatArray:
    """(n,) dimensionless."""
    q, p = known[atom.of], atom.parameters
    match atom.form:
        case "power":
            return np.asarray((np.abs(q) / p[0]) ** p[1])
        case "sign":
            return np.asarray(np.sign(q))
        case "cosine":
            return np.asarray(np.cos(p[0] * q - p[1]))
        case "slope":
            return np.asarray((q[:, 0] * np.cos(p[1]) + q[:, 1] * np.sin(p[1])) / p[0])
        case "half":
            return np.asarray(q[:, 0] * np.cos(p[0]) + q[:, 1] * np.sin(p[0]) > p[1], dtype=float)
        case "disc":
            away = (q[:, 0] - p[0]) ** 2 + (q[:, 1] - p[1]) ** 2
            return np.asarray(away < p[2] ** 2, dtype=float)
        case "below":
            size = np.abs(q) if atom.of in SPEEDS else q
            return np.asarray(size < p[0], dtype=float)
        case "fade":
            return np.asarray(np.exp(-np.maximum(q, 0.0) / p[0]))
        case "curve":
            nodes = np.linspace(p[0], p[1], len(p) - 2)
            turned = np.mod(q, 2.0 * np.pi) if atom.of == "heading" else q
            return np.asarray(np.interp(turned, nodes, p[2:]))
        case "always":
            return np.ones(len(q))
        case "over":
            return np.asarray(1.0 - p[0] / np.maximum(np.abs(q), p[0]))


def product(atoms: Sequence[Atom], known: Known) -> FloatArray:
    """(n,) of all of a law's atoms."""
    found = value(atoms[0], known)
    for atom in atoms[1:]:
        found = found * value(atom, known)
    return found
