"""Linear algebra on one thread: the same bits on the same machine, whoever else uses it.

Sums over several threads are rounded in another order, and the matrices here are too small to gain.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Given = ParamSpec("Given")
Result = TypeVar("Result")


def one_thread(work: Callable[Given, Result]) -> Callable[Given, Result]:
    """The work, done with one thread of linear algebra."""

    @wraps(work)
    def alone(*args: Given.args, **words: Given.kwargs) -> Result:
        with threadpool_limits(limits=1, user_api="blas"):
            return work(*args, **words)

    return alone
