"""Captured sensor readings of a nominal robot, as the point model looks them up (paper, III-E)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Tables:
    """Captured sensor readings of a nominal robot; axes as documented in `rg_tables`."""

    ps_counts: npt.NDArray[np.float32]
    """(8, distances, incidences) counts."""
    ps_range: float
    """m; the distance axis is `ps_range * u**2`, u uniform in [0, 1]."""
    ps_noise: FloatArray
    """(8,) half width of uniform noise relative to the reading."""
    ps_noise_floor: float
    """counts, half width of uniform noise."""
    ls_counts: npt.NDArray[np.float32]
    """(distances, bearings) counts below dark; bearings from -pi, uniform on the circle."""
    ls_range: float
    """m; the distance axis is `ls_range * u**2`."""
    ls_dark: float
    """counts in the dark."""
    ls_noise: float
    """counts, half width of uniform noise."""
    counts_max: float = 4095.0
    """12-bit converter."""
