"""Captured sensor readings of a nominal robot, as the point model looks them up (paper, III-E)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.binding import array, finite
from realitygap.embedded_sim.errors import InputError

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

    @cached_property
    def checked(self) -> Tables:
        """The same tables, their arrays as C reads them.

        Raises:
            InputError: an array of another shape, or a number that no sensor reads.
        """
        ps = array("tables.ps_counts", self.ps_counts, np.float32, (8, None, None))
        ls = array("tables.ls_counts", self.ls_counts, np.float32, (None, None))
        noise = array("tables.ps_noise", self.ps_noise, np.float64, (8,))
        for name, found in (("ps_counts", ps), ("ls_counts", ls), ("ps_noise", noise)):
            if found.ndim > 1 and min(found.shape) < 2:
                expected = "at least two nodes on every axis"
                raise InputError(f"tables.{name}", f"shape {found.shape}", expected)
            if not np.isfinite(found).all():
                raise InputError(f"tables.{name}", "values that are not finite", "finite counts")
        for name in ("ps_noise_floor", "ls_dark", "ls_noise", "counts_max"):
            finite(f"tables.{name}", (getattr(self, name),), 1)
        for name in ("ps_range", "ls_range"):
            (reach,) = finite(f"tables.{name}", (getattr(self, name),), 1)
            if reach <= 0.0:
                raise InputError(f"tables.{name}", f"{reach:g}", "a range above 0 m")
        return replace(self, ps_counts=ps, ls_counts=ls, ps_noise=noise)
