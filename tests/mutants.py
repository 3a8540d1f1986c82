"""Do the tests notice faults? Single changes of behaviour, and the tests that must fail with each.

`mutants.toml` lists the changes. Each is made in a copy of the tree, where the tests named beside
it are run: the change is *killed* if one of them fails, and *survives* if none does. The C is built
once, with all its changes behind a switch. By hand only: `make mutants`, or some of them with
`python -m tests.mutants NAME...`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import NamedTuple

from rich.console import Console

ROOT = Path(__file__).parents[1]
LIST = Path(__file__).with_suffix(".toml")
JOBS = os.cpu_count() or 1
"""Copies of the tree that are worked in at once."""
SECONDS = 1800.0
"""s after which tests are stopped; our choice, far beyond what any of them needs."""
PASSED, FAILED = 0, 1
"""Exit codes of pytest; all others mean that the tests could not be run."""
WORDS: Mapping[int | None, str] = {FAILED: "killed", PASSED: "SURVIVED"}

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

    code: int | None
    """Of pytest; None: they did not end."""
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
    """Copy the tree as it is, without what git ignores."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in listed.stdout.split("\0"):
        if name and (ROOT / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, to / name)


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


def _environment(tree: Path, number: int = 0) -> dict[str, str]:
    own = {k: v for k, v in os.environ.items() if k != "REALITYGAP_DEVELOPMENT"}
    return {**own, "PYTHONPATH": str(tree), "RG_MUTANT": str(number)}


def judged(tree: Path, tests: Sequence[str], number: int = 0) -> Outcome:
    """Run tests in a copy until one fails."""
    # no byte code is kept: a file changed twice within a second would be taken for unchanged
    command = [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    spread = ["-n", str(JOBS)] if number == 0 and JOBS > 1 else ["-x", "-p", "no:xdist"]
    try:
        run = subprocess.run(
            [*command, *spread, *tests],
            cwd=tree,
            env=_environment(tree, number),
            capture_output=True,
            text=True,
            check=False,
            timeout=SECONDS,
        )
    except subprocess.TimeoutExpired:
        return Outcome(None, (), f"no end after {SECONDS:g} s")
    lines = (run.stdout.strip() or run.stderr.strip() or "nothing said").splitlines()
    failed = [line.split(" - ")[0] for line in lines if line.startswith("FAILED ")]
    names = tuple(line.removeprefix("FAILED ") for line in failed)
    return Outcome(run.returncode, names, lines[-1])


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
    with TemporaryDirectory(prefix="mutants-") as scratch:
        trees: SimpleQueue[Path] = SimpleQueue()
        first = Path(scratch) / "0"
        copied(first)
        built(first, everything)
        for k in range(1, min(JOBS, len(mutants))):
            shutil.copytree(first, Path(scratch) / str(k))
            trees.put(Path(scratch) / str(k))
        trees.put(first)

        def tried(one: Mutant) -> Outcome:
            tree, began = trees.get(), time.perf_counter()
            with made(tree, one):
                found = judged(tree, one.tests, everything.index(one) + 1)
            trees.put(tree)
            word = WORDS.get(found.code, "NOT RUN")
            texts: Mapping[int | None, str] = {PASSED: f"({one.file}): {one.why}", FAILED: ""}
            more = texts.get(found.code, found.said)
            took = f"{time.perf_counter() - began:6.1f} s"
            console.print(f"{word:8} {took}  {one.name} {more}", soft_wrap=True, highlight=False)
            return found

        with ThreadPoolExecutor(JOBS) as pool:
            found = dict(zip(mutants, pool.map(tried, mutants), strict=True))
        killed = {one: tuple(was.failed) for one, was in found.items() if was.code == FAILED}
        witnesses = sorted({name for names in killed.values() for name in names})
        sound = judged(first, witnesses) if witnesses else Outcome(PASSED, (), "")
        if sound.code not in (PASSED, FAILED):
            console.print(f"without any change: {sound.said}", highlight=False)
            return len(mutants)
        for name in sound.failed:
            console.print(f"fails without any change: {name}", soft_wrap=True, highlight=False)
        return sum(not set(killed.get(one, ())) - set(sound.failed) for one in mutants)


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
    sys.exit(main(sys.argv[1:]))
