"""Where a result comes from: the program that computed it, the files it read; JSON in one way."""

from __future__ import annotations

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from realitygap.embedded_sim.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("embedded_sim", "reality", "models", "studies")
"""Folders of `ROOT` that the program is."""
SOURCES = (".py", ".c", ".h", ".toml", ".npz", ".json", ".j2", ".css", ".md")
"""Endings of what people wrote, and of the data that ships."""
EXTRA = ("pybullet", "mujoco-core")
"""Libraries that matter where they are installed."""
MADE = ("_core.c", "_optics.c")
"""Written by cffi, with its own version in it."""


def versions() -> dict[str, str]:
    """What computed a result: this package, its sources, Python, and libraries that matter."""
    return dict(_versions())


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    names = ["reality-gap", "numpy", "scipy", "pandas", "pyarrow"]
    names += [name for name in EXTRA if find_spec(name.partition("-")[0])]
    return (
        ("python", platform.python_version()),
        *((name, version(name)) for name in names),
        ("program", sources_hash(ROOT / room for room in ROOMS)),
    )


@cache
def commit() -> str | None:
    """The commit of the sources, with `-dirty` if they differ from it; None: no checkout."""
    if not (ROOT / ".git").exists():
        return None
    words = ("git", "-C", str(ROOT), "describe", "--always", "--dirty", "--exclude=*")
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()


def sources_hash(folders: Iterable[Path]) -> str:
    """SHA-256 over all sources and shipped data in some folders, by their names and contents."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.suffix in SOURCES and path.name not in MADE:
                name = path.relative_to(folder.parent).as_posix()
                digest.update(f"{name}\0{file_sha256(path)}\0".encode())
    return digest.hexdigest()


def file_sha256(path: Path) -> str:
    """SHA-256 of a file's content; a large file is never in memory as a whole."""
    with path.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def file_read(option: str, path: Path, name: str | None = None) -> dict[str, str]:
    """An entry of `inputs`: who asked for a file, what it is called, and what was in it.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return {"option": option, "file": name or str(path), "sha256": file_sha256(path)}
    except OSError as error:
        raise InputError(option, path, f"a file that can be read ({error.strerror})") from None


def write_json(path: Path, content: object) -> None:
    """Indented JSON with a final newline; NaN is refused."""
    path.write_bytes(as_json_bytes(content))


def as_json_bytes(content: object) -> bytes:
    """The content of such a file."""
    return (json.dumps(content, indent=1, allow_nan=False) + "\n").encode()
