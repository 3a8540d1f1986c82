"""Captured sensor tables as a file: what a nominal robot's sensors read, by distance and angle.

The file is an uncompressed NumPy archive: one member per field of `Tables`, and `about`, a JSON
text with the unit and the axes of each. The same arrays give the same bytes.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS, InputError, Tables
from realitygap.models.log.opened import opened, parsing

ABOUT = {
    "ps_counts": "counts; sensor (ps0..ps7) x distance (m, ps_range * u^2, u uniform in [0, 1]) "
    "x incidence (cosine of the angle to the wall's normal, uniform in [0, 1])",
    "ps_range": "m",
    "ps_noise": "half width of uniform noise, relative to the reading; sensor (ps0..ps7)",
    "ps_noise_floor": "counts, half width of uniform noise",
    "ls_counts": "counts below dark; distance (m, ls_range * u^2, u uniform in [0, 1]) "
    "x bearing (rad, from the sensor's axis to the lamp, from -pi, uniform on the circle)",
    "ls_range": "m",
    "ls_dark": "counts in the dark",
    "ls_noise": "counts, half width of uniform noise",
    "counts_max": "counts, largest of the converter",
}
"""Unit and axes of each member."""
DIMENSIONS = {"ps_counts": 3, "ps_noise": 1, "ls_counts": 2}
"""Dimensions of the members that are not single numbers."""
MOST_BYTES = 2**24
"""Of the file, and of a member. Our choice: five hundred times the shipped tables."""
EXPECTED = "a file written by `realitygap capture`"
SINGLE = ("ps_counts", "ls_counts")
"""Members kept in single precision, as C reads them."""


def save_tables(tables: Tables, path: Path) -> None:
    """Write captured tables; the same tables give the same bytes."""
    path.write_bytes(tables_bytes(tables))


def tables_bytes(tables: Tables) -> bytes:
    """The content of such a file."""
    arrays = {name: np.asarray(getattr(tables, name)) for name in ABOUT}
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, about=np.array(json.dumps(ABOUT)), **arrays)
    return file.getvalue()


def load_tables(path: Path) -> Tables:
    """Read captured tables.

    Raises:
        InputError: there is no such file, it is not such an archive, or its values cannot be used.
    """
    with (
        opened(path, EXPECTED, most=MOST_BYTES) as file,
        parsing(str(path), EXPECTED),
        zipfile.ZipFile(file) as archive,
    ):
        arrays = {name: _array(archive, name, path) for name in ABOUT}
    for name, array in arrays.items():
        _check(path, name, array)
    singles = {name: np.ascontiguousarray(arrays[name], dtype=np.float32) for name in SINGLE}
    noise = np.ascontiguousarray(arrays["ps_noise"], dtype=np.float64)
    numbers = {name: float(array) for name, array in arrays.items() if array.ndim == 0}
    return Tables(
        ps_counts=singles["ps_counts"], ls_counts=singles["ls_counts"], ps_noise=noise, **numbers
    )


def _array(archive: zipfile.ZipFile, name: str, path: Path) -> npt.NDArray[Any]:
    """A member, if its header asks for no more than it holds.

    NumPy's own reader takes memory for what the header says before it looks for the numbers.
    """
    with archive.open(f"{name}.npy") as member:
        kind = np.lib.format.read_magic(member)
        read = {(1, 0): np.lib.format.read_array_header_1_0}.get(kind)
        shape, _, dtype = (read or np.lib.format.read_array_header_2_0)(member)
    size, held = math.prod(shape) * dtype.itemsize, archive.getinfo(f"{name}.npy").file_size
    if size > held or held > MOST_BYTES:
        said = f"shape {shape} in {held} bytes"
        raise InputError(f"{path.name}: {name}", said, f"its numbers, {MOST_BYTES} bytes at most")
    with archive.open(f"{name}.npy") as member:
        return np.lib.format.read_array(member, allow_pickle=False)


def _check(path: Path, name: str, array: npt.NDArray[Any]) -> None:
    """Refuse a member of the wrong kind or shape, or with values no sensor reads."""
    dimensions = DIMENSIONS.get(name, 0)
    where = f"{path.name}: {name}"
    if array.dtype.kind not in "fiu" or array.ndim != dimensions:
        got = f"{array.dtype} of shape {array.shape}"
        raise InputError(where, got, f"numbers in {dimensions} dimensions")
    if name.startswith("ps_") and dimensions and len(array) != SENSORS:
        raise InputError(where, f"{len(array)} sensors", str(SENSORS))
    if min(array.shape[-2:], default=2) < 2:
        raise InputError(where, f"shape {array.shape}", "at least two nodes on every axis")
    if not np.isfinite(array).all() or (array < 0).any():
        raise InputError(where, "negative or non-finite values", "finite values >= 0")
    if name.endswith("_range") and not (array > 0).all():
        raise InputError(where, float(array), "a range above 0 m")
