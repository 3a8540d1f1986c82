"""Where Python meets C: values become C's, and what C refuses becomes an exception.

C looks at every structure that it is given (`core/check.c`) and says which field it refuses. What
it cannot see is settled here: how many values there are, and how long an array is.
"""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim._core import ffi, lib
from realitygap.embedded_sim.errors import Diverged, InputError

REFUSED: Any = ffi.typeof("rg_refusal *")
SHOWN = 80
"""Letters of a refused value that are shown."""


def refusal() -> Any:
    """A C struct `rg_refusal` for a call to fill."""
    return ffi.new(REFUSED)


def check(status: int, why: Any) -> None:
    """Raise what a call's status says.

    Raises:
        InputError: something was not finite, out of range, missing, or leaves no room for food.
        Diverged: numbers in range led out of the finite ones; says where.
    """
    if status == lib.RG_OK:
        return
    field, index = ffi.string(why.field).decode(), int(why.index)
    if status == lib.RG_BAD_ARGUMENT:
        where = field if index < 0 else f"{field}[{index}]"
        raise InputError(where, f"{why.got:.15g}", _range(why.low, why.high))
    if status == lib.RG_NO_ROOM:
        tried = f"no place outside it in {lib.RG_DRAWS} draws (trial {index}, step {why.step})"
        raise InputError("nest", tried, "a nest that leaves room for food in the arena")
    step = f", step {why.step}" if field == "trial" else ""
    raise Diverged(f"the point model left the finite numbers: {field} {index}{step}")


def _range(low: float, high: float) -> str:
    """In words."""
    least = "" if abs(low) >= sys.float_info.max else f" from {low:.15g}"
    if math.isinf(high):
        return f"a number{least}, or infinity"
    if high >= sys.float_info.max:
        return f"a finite number{least}"
    return f"a number{least} to {high:.15g}"


def structure(kind: str, name: str, values: dict[str, Any], lengths: dict[str, int]) -> Any:
    """A C struct of numbers and of arrays of so many.

    Raises:
        InputError: a value is no number, or an array has not as many.
    """
    try:
        if all(len(values[field]) == length for field, length in lengths.items()):
            return ffi.new(kind, values)
    except (TypeError, OverflowError):
        pass  # not what cffi takes as it is: number by number, to say which it was
    converted: dict[str, Any] = {}
    for field, value in values.items():
        several = lengths.get(field)
        found = numbers(f"{name}.{field}", value if several else (value,), several or 1)
        converted[field] = found if several else found[0]
    return ffi.new(kind, converted)


def numbers(field: str, values: Any, count: int) -> list[float]:
    """So many numbers as C takes them.

    Raises:
        InputError: they are not numbers, or not as many.
    """
    try:
        found = [float(value) for value in values]
    except (TypeError, ValueError, OverflowError):
        raise InputError(field, _short(values), f"{count} numbers") from None
    if len(found) != count:
        raise InputError(field, f"{len(found)} numbers", f"{count} numbers")
    return found


def finite(field: str, values: Any, count: int) -> list[float]:
    """So many finite numbers.

    Raises:
        InputError: they are not numbers, not finite, or not as many.
    """
    found = numbers(field, values, count)
    for value in found:
        if not math.isfinite(value):
            raise InputError(field, f"{value:g}", "a finite number")
    return found


def whole(field: str, value: Any) -> int:
    """A whole number that C can hold, so that C says whether it is in range.

    Raises:
        InputError: it is none.
    """
    (exact,) = finite(field, (value,), 1)
    if not exact.is_integer() or abs(exact) >= 2.0**31:
        raise InputError(field, f"{exact:g}", "a whole number within 32 bits")
    return int(exact)


def array(
    field: str, values: npt.ArrayLike, dtype: npt.DTypeLike, shape: tuple[int | None, ...]
) -> npt.NDArray[Any]:
    """The values as a contiguous array of one type and shape; None: any length.

    Raises:
        InputError: they are not, or a number does not fit the type.
    """
    kind = np.dtype(dtype)
    try:
        given = np.asarray(values)
        with np.errstate(invalid="ignore"):
            found = np.ascontiguousarray(given, dtype=kind)
    except (TypeError, ValueError, OverflowError):
        raise InputError(field, _short(values), f"numbers of kind {kind}") from None
    rows = "rows" if shape[0] is None else shape[0]
    expected = "(" + ", ".join(str(n) for n in (rows, *shape[1:])) + ("," * (len(shape) == 1)) + ")"
    if given.ndim != len(shape) or any(
        n not in (None, m) for n, m in zip(shape, given.shape, strict=True)
    ):
        raise InputError(field, f"shape {given.shape}", f"shape {expected}")
    if kind.kind in "iu" and given.dtype != kind and not np.array_equal(found, given):
        raise InputError(field, "numbers that do not fit", f"whole numbers of kind {kind}")
    return found


def memory(kind: str, array: npt.NDArray[Any]) -> Any:
    """An array's memory as a C pointer; the caller keeps the array alive."""
    return ffi.from_buffer(kind, array)


def _short(value: Any) -> str:
    try:
        text = repr(value)
    except ValueError:  # a whole number of more digits than Python writes
        text = f"a {type(value).__name__} too long to show"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
