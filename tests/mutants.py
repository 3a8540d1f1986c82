"""Do the tests notice faults? Single changes of behaviour, and the tests that must fail with each.

`mutants.toml` lists the changes. Each is made in a copy of the tree, where the tests named beside
it are run: the change is *killed* if one of them fails, and *survives* if none does. The C is built
once, with all its changes behind a switch. By hand only: `make mutants`, or some of them with
`python -m tests.mutants NAME...`.
"""

from __future__ import annotations

import importlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import NamedTuple

import pytest
from rich.console import Console

ROOT = Path(__file__).parents[1]
LIST = Path(__file__).with_suffix(".toml")
JOBS = os.cpu_count() or 1
"""Copies of the tree that are worked in at once."""
SECONDS = 1800
"""s after which tests are stopped; our choice, far beyond what any of them needs."""
SERVE, SAID = "--serve", "mutant.out"
"""The word by which this module runs tests in a copy, and the file there that has what they say."""
LIBRARIES = ("scipy.stats", "pandas", "pyarrow.parquet", "pydantic")
"""What nearly all tests import, loaded once: nothing of this project, which changes, and nothing
that pytest loads itself."""
PASSED, FAILED, BROKEN = 0, 1, 3
"""Exit codes of pytest; all others mean, as the last, that the tests could not be run."""
WORDS = {FAILED: "killed", PASSED: "SURVIVED"}

SWITCH = """
char *getenv(const char *);
int atoi(const char *);
static int rg_mutant(int number) {
    static int chosen = -1;
    if (chosen < 0) {
        const char *said = getenv("RG_MUTANT");
        chosen = said ? atoi(said) : 0;
    }
    return chosen == number;
}
"""
"""C that is put before every file: which change is switched on. It includes nothing, or cffi's own
file would find its headers read without the names that it needs."""


class Outcome(NamedTuple):
    """What became of some tests."""

    code: int
    """Of pytest; negative: a signal ended it."""
    failed: tuple[str, ...]
    said: str
    """The last line."""


@dataclass(frozen=True, kw_only=True)
class Mutant:
    """One change."""

    name: str
    file: str
    """Path below the root."""
    old: str
    """Text of the file, which occurs there once. In C an expression."""
    new: str
    tests: tuple[str, ...]
    """What pytest is to run."""
    why: str
    """What would be wrong, and whom it would mislead."""

    @property
    def compiled(self) -> bool:
        """Whether it is C."""
        return self.file.endswith((".c", ".h"))


def read(path: Path = LIST) -> list[Mutant]:
    """The list."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    return [Mutant(**{**entry, "tests": tuple(entry["tests"])}) for entry in entries]


def stale(mutants: Sequence[Mutant], root: Path = ROOT) -> list[str]:
    """What is wrong with the list, a line each: it must be mended with the code it is about."""
    said = []
    for index, one in enumerate(mutants):
        path = root / one.file
        number = path.read_text(encoding="utf-8").count(one.old) if path.is_file() else 0
        if number != 1:
            said.append(f"{one.name}: old text found {number} times in {one.file}, expected once")
        if one.new == one.old:
            said.append(f"{one.name}: changes nothing")
        for other in mutants[:index]:
            if other.name == one.name:
                said.append(f"{one.name}: twice in the list")
            if (other.file, other.old, other.new) == (one.file, one.old, one.new):
                said.append(f"{one.name}: the same change as {other.name}")
        for test in one.tests:
            file, *names = test.split("::")
            known = (root / file).exists() and all(
                f"def {name.split('[')[0]}(" in (root / file).read_text(encoding="utf-8")
                for name in names
            )
            if not known:
                said.append(f"{one.name}: no test {test}")
    return said


def changed(text: str, mutants: Sequence[Mutant], numbers: Sequence[int]) -> str:
    """C with its changes behind the switch."""
    places = sorted(
        ((text.index(one.old), one, number) for one, number in zip(mutants, numbers, strict=True)),
        key=lambda place: -place[0],
    )
    for at, one, number in places:
        either = f"(rg_mutant({number}) ? ({one.new}) : ({one.old}))"
        text = text[:at] + either + text[at + len(one.old) :]
    return text


def copied(to: Path) -> None:
    """Copy the tree as it is, without what git ignores; the package's links stay links."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in listed.stdout.split("\0"):
        there = ROOT / name
        if name and (there.is_file() or there.is_symlink()):  # a room is a link to a folder
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(there, to / name, follow_symlinks=False)


def built(tree: Path, mutants: Sequence[Mutant]) -> None:
    """Build the extensions in a copy, with the changes of the C behind the switch."""
    compiled = [(number, one) for number, one in enumerate(mutants, 1) if one.compiled]
    for file in {one.file for _, one in compiled}:
        numbers, mine = zip(*((n, one) for n, one in compiled if one.file == file), strict=True)
        path = tree / file
        path.write_text(changed(path.read_text(encoding="utf-8"), mine, numbers), encoding="utf-8")
    switch = tree / "mutant_switch.h"
    switch.write_text(SWITCH, encoding="utf-8")
    build = [sys.executable, "setup.py", "--quiet", "build_ext", "--inplace", "--force"]
    flags = {"CFLAGS": f"-include {switch} -Wno-unused-function"}
    subprocess.run(build, cwd=tree, env={**_environment(tree), **flags}, check=True)
    subprocess.run([sys.executable, "-m", "compileall", "-q", "."], cwd=tree, check=True)


def _environment(tree: Path) -> dict[str, str]:
    """Of what runs in a copy: its own modules come first, and hypothesis, told by CI, draws the
    same examples every time and sets no deadline that a busy machine would miss."""
    own = {k: v for k, v in os.environ.items() if k != "REALITYGAP_DEVELOPMENT"}
    return {**own, "CI": "1", "PYTHONPATH": str(tree)}


class Copy:
    """A copy of the tree, and a process in it that runs tests."""

    def __init__(self, tree: Path) -> None:
        self.tree = tree
        # no byte code is kept: a file changed twice within a second would be taken for unchanged
        self._server = subprocess.Popen(
            [sys.executable, "-B", "-m", "tests.mutants", SERVE],
            cwd=tree,
            env=_environment(tree),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def close(self) -> None:
        """End the process."""
        self._server.communicate()

    def judged(self, tests: Sequence[str], number: int = 0) -> Outcome:
        """Run tests, with a change of the C switched on."""
        assert self._server.stdin is not None
        assert self._server.stdout is not None
        self._server.stdin.write(json.dumps([number, *tests]) + "\n")
        self._server.stdin.flush()
        code = int(self._server.stdout.readline())
        text = (self.tree / SAID).read_text(encoding="utf-8", errors="replace")
        lines = text.strip().splitlines()
        failed = [line.split(" - ")[0] for line in lines if line.startswith("FAILED ")]
        names = tuple(line.removeprefix("FAILED ") for line in failed)
        if code == FAILED and not names:
            code = BROKEN
        return Outcome(code, names, lines[-1] if lines else "nothing said")


def serve() -> None:
    """In a copy: run the tests asked for line by line, each time in a fork that begins with the
    libraries loaded, and answer with pytest's exit code."""
    for library in LIBRARIES:
        importlib.import_module(library)
    for line in sys.stdin:
        number, *tests = json.loads(line)
        child = os.fork()
        if child == 0:
            os.environ["RG_MUTANT"] = str(number)
            out = os.open(SAID, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(out, 1)
            os.dup2(out, 2)
            signal.alarm(SECONDS)
            code = pytest.main(["-q", "-p", "no:cacheprovider", "-p", "no:xdist", *tests])
            sys.stdout.flush()
            os._exit(code)
        sys.stdout.write(f"{os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])}\n")
        sys.stdout.flush()


@contextmanager
def made(tree: Path, one: Mutant) -> Iterator[None]:
    """The change in a copy; that of C is there already, behind its switch."""
    path = tree / one.file
    text = path.read_text(encoding="utf-8")
    if not one.compiled:
        path.write_text(text.replace(one.old, one.new), encoding="utf-8")
    try:
        yield
    finally:
        path.write_text(text, encoding="utf-8")


def survivors(mutants: Sequence[Mutant], everything: Sequence[Mutant], console: Console) -> int:
    """Try each change; how many are not killed.

    A test that fails with a change must pass without: those that failed are run once more.
    """
    with TemporaryDirectory(prefix="mutants-") as scratch, ExitStack() as stack:
        first = Path(scratch) / "0"
        copied(first)
        built(first, everything)
        free: SimpleQueue[Copy] = SimpleQueue()
        for k in range(JOBS):
            if k:
                shutil.copytree(first, Path(scratch) / str(k), symlinks=True)
            copy = Copy(Path(scratch) / str(k))
            stack.callback(copy.close)
            free.put(copy)

        def tried(one: Mutant) -> Outcome:
            copy, began = free.get(), time.perf_counter()
            with made(copy.tree, one):
                found = copy.judged(one.tests, everything.index(one) + 1)
            free.put(copy)
            texts = {PASSED: f"({one.file}): {one.why}", FAILED: ""}
            word, more = WORDS.get(found.code, "NOT RUN"), texts.get(found.code, found.said)
            took = f"{time.perf_counter() - began:6.1f} s"
            console.print(f"{word:8} {took}  {one.name} {more}", soft_wrap=True, highlight=False)
            return found

        def unchanged(tests: Sequence[str]) -> Outcome:
            copy = free.get()
            found = copy.judged(tests) if tests else Outcome(PASSED, (), "")
            free.put(copy)
            return found

        with ThreadPoolExecutor(JOBS) as pool:
            found = dict(zip(mutants, pool.map(tried, mutants), strict=True))
            killed = {one: was.failed for one, was in found.items() if was.code == FAILED}
            witnesses = sorted({name for names in killed.values() for name in names})
            sound = list(pool.map(unchanged, [witnesses[k::JOBS] for k in range(JOBS)]))
    unsound = {name for part in sound for name in part.failed}
    for part in sound:
        if part.code != PASSED:
            console.print(f"without any change: {part.said}", soft_wrap=True, highlight=False)
            unsound |= set() if part.failed else set(witnesses)
    for name in sorted(unsound):
        console.print(f"fails without any change: {name}", soft_wrap=True, highlight=False)
    return sum(not set(killed.get(one, ())) - unsound for one in mutants)


def main(names: Sequence[str]) -> int:
    """Try all changes, or those named; 1 if any survives or no longer applies."""
    console = Console()
    everything = read()
    unknown = set(names) - {one.name for one in everything}
    said = [*stale(everything), *(f"{name}: not in the list" for name in sorted(unknown))]
    if said:
        console.print("\n".join(said), soft_wrap=True, highlight=False)
        return 1
    chosen = [one for one in everything if not names or one.name in names]
    began = time.perf_counter()
    left = survivors(chosen, everything, console)
    took = time.perf_counter() - began
    console.print(f"{len(chosen) - left} of {len(chosen)} killed in {took:.0f} s")
    return int(left > 0)


if __name__ == "__main__":
    if sys.argv[1:] == [SERVE]:
        serve()
    else:
        sys.exit(main(sys.argv[1:]))
