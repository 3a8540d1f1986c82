"""Files from outside, opened with care.

A file is a regular one of a stated size at most, so that no pipe or device is waited for or read
without end. Whatever its parser raises becomes one `InputError`, here and nowhere else.
"""

from __future__ import annotations

import json
import os
import re
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.errors import reason

MOST_TOML = 2**20
"""bytes of a model file or map. Our choice: fifty times the longest model that we write."""
MOST_JSON = 2**26
"""bytes of a JSON file. Our choice: 800 times the longest shipped reference."""
DEEPEST = 16
"""Parts of a dotted key. `tomllib` keeps the square of their number; ours have four."""

_PART = r"""(?:[\w-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""
_TOO_DEEP = re.compile(rf"(?<![\w-])(?:{_PART}[ \t]*\.[ \t]*){{{DEEPEST}}}")


@contextmanager
def parsing(field: str, expected: str) -> Iterator[None]:
    """Turn whatever a parser raises in the block into one `InputError`.

    Libraries raise nearly anything for broken bytes: `RecursionError`, `zlib.error`, `KeyError`,
    `OverflowError`, `MemoryError`. Keep the block to the parser's call.

    Args:
        field: What is read.
        expected: What it should be.

    Raises:
        InputError: the block raised an exception; its own `InputError` passes as it is.
    """
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        raise InputError(field, reason(error), expected) from error


@contextmanager
def opened(path: Path, expected: str, *, most: int, field: str | None = None) -> Iterator[BinaryIO]:
    """A regular file for reading bytes.

    Args:
        path: The file.
        expected: What it should be, in a refusal.
        most: bytes it may have.
        field: What is read, in a refusal; its path if absent.

    Raises:
        InputError: it is absent, may not be read, is a directory, pipe or device, or is larger.
    """
    name, seen = (str(path), "") if field is None else (field, f"{path}: ")
    try:
        # without waiting: a pipe that nobody writes into would hold us for ever
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise InputError(name, f"{seen}{reason(error)}", expected) from None
    try:
        found = os.fstat(handle)
        if not stat.S_ISREG(found.st_mode):
            raise InputError(name, f"{seen}no regular file", expected)
        if found.st_size > most:
            raise InputError(name, f"{seen}{found.st_size} bytes", f"at most {most}: {expected}")
    except InputError:
        os.close(handle)
        raise
    with os.fdopen(handle, "rb") as file:
        yield file


def read_text(path: Path, expected: str, *, most: int, field: str | None = None) -> str:
    """The whole of a UTF-8 file; arguments and refusals as `opened`."""
    with (
        opened(path, expected, most=most, field=field) as file,
        parsing(field or str(path), expected),
    ):
        return file.read(most).decode("utf-8")


def toml_values(path: Path, expected: str, *, field: str | None = None) -> dict[str, Any]:
    """What a TOML file holds; arguments and refusals as `opened`, and broken TOML."""
    text = read_text(path, expected, most=MOST_TOML, field=field)
    if _TOO_DEEP.search(text):
        raise InputError(field or str(path), f"a key of {DEEPEST} parts or more", expected)
    with parsing(field or str(path), expected):
        return tomllib.loads(text)


def json_values(path: Path, expected: str, *, field: str | None = None) -> Any:
    """What a JSON file holds; arguments and refusals as `opened`, and broken JSON."""
    text = read_text(path, expected, most=MOST_JSON, field=field)
    with parsing(field or str(path), expected):
        return json.loads(text)
