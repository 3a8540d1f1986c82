"""Kills commands at random instants and looks at what they leave: `make kills`.

    python -m tests.kills --kills study=200 run=50 --seed 1 --minutes 60

Every kill draws an instant, a signal (INT, TERM, HUP, KILL) and a victim: the command itself, one
of its workers, or a process that diagnoses for it. Afterwards it must hold that

- no process of the command is left within 10 s, and none said a traceback;
- its exit code tells the truth: 0, 1 (workers died), or the signal's;
- the same command, given again, ends well and leaves no room beside its output and none for
  temporary files;
- its output then has the bytes of an undisturbed one, but for wall times.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

COMMAND = Path(sys.executable).with_name("realitygap")
MARK = "REALITYGAP_KILLS"
"""Variable that marks the processes of a command, whatever session they are in."""
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)
VICTIMS = ("parent", "worker", "diagnosis")
NOBODY = "nobody: it had ended"
WALL_TIMES = (
    "wall_seconds",
    "sessions",
    "record_seconds",
    "diagnose_seconds",
)
"""Keys of JSON files that hold wall times; the page of a study, a battery and a transfer shows
them, so that `report.html` is compared for the other commands alone."""
GONE = 10.0
"""s within which a command's processes must be gone."""
PATIENCE = 900.0
"""s for a command to end on a busy machine."""
EFFECT = "command_latency:seconds=0.1,robot=1"


@dataclass(frozen=True)
class Kind:
    """A command that is killed."""

    name: str
    words: str
    """As typed, without `--out`."""
    resumes: bool
    """Whether it goes on; otherwise it is run anew, with `--force` where it had finished."""

    @property
    def page(self) -> bool:
        """Whether `report.html` holds no wall times."""
        return not self.resumes


TINY = "--robots 2 --seed 5 --quiet"
KINDS = (
    Kind("study", f"study paper --runs 1 --minutes 0.05 --jobs 2 {TINY}", True),
    Kind("run", f"run --minutes 0.5 {TINY}", False),
    Kind("diagnose", "diagnose log --seed 1 --quiet", False),
    Kind(
        "gain",
        f"gain --log log --extended model/extended.toml --effect {EFFECT} --runs 1 --minutes 0.3 "
        "--jobs 2 --quiet",
        False,
    ),
    Kind(
        "transfer",
        f"study transfer --effect {EFFECT} --case no-light --runs 1 --bars 1 --minutes 0.3 "
        f"--trials 1 --jobs 2 {TINY}",
        True,
    ),
    Kind(
        "blind",
        "blind --trials 3 --seconds 10 --only command_latency --seed 2 --jobs 2 --quiet",
        True,
    ),
)


@dataclass
class Tally:
    """What became of the kills of a kind."""

    kills: int = 0
    hit: Counter[str] = field(default_factory=Counter)
    """Signal and victim."""
    codes: Counter[int] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    left: int = 0
    """Kills after which there was something for the next command to clear."""


def digests(out: Path, kind: Kind) -> dict[str, str]:
    """Of every file of an output, without wall times."""
    found = {}
    for path in sorted(p for p in out.rglob("*") if p.is_file()):
        if path.name == "report.html" and not kind.page:
            continue
        content = path.read_bytes()
        if path.suffix == ".json":
            told = _timeless(json.loads(content))
            if path.name == "manifest.json":  # its files are compared themselves, without times
                told["files"] = sorted(told["files"])
            content = json.dumps(told).encode()
        found[str(path.relative_to(out))] = hashlib.sha256(content).hexdigest()
    return found


def _timeless(content: Any) -> Any:
    if isinstance(content, dict):
        return {k: _timeless(v) for k, v in content.items() if k not in WALL_TIMES}
    return [_timeless(v) for v in content] if isinstance(content, list) else content


class Place:
    """A directory with the inputs, the output and the temporary files of one command."""

    def __init__(self, where: Path, inputs: Path, kind: Kind) -> None:
        self.where, self.kind = where, kind
        self.out, self.tmp = where / "out", where / "tmp"
        self.mark = where.name
        self.tmp.mkdir(parents=True)
        for path in inputs.iterdir():
            (where / path.name).symlink_to(path)

    def start(self, *more: str) -> subprocess.Popen[str]:
        """The command."""
        environment = {k: v for k, v in os.environ.items() if k != "REALITYGAP_ROOM"}
        environment |= {MARK: self.mark, "TMPDIR": str(self.tmp)}
        with (self.where / "said").open("a") as said:
            return subprocess.Popen(
                [str(COMMAND), *self.kind.words.split(), "--out", "out", *more],
                cwd=self.where,
                env=environment,
                stdout=said,
                stderr=said,
                text=True,
                start_new_session=True,
            )

    def processes(self) -> dict[int, str]:
        """Processes of the command that run, and what each is."""
        found = {}
        for path in Path("/proc").glob("[0-9]*"):
            try:
                if f"{MARK}={self.mark}\0".encode() not in (path / "environ").read_bytes():
                    continue
                words = (path / "cmdline").read_bytes().decode(errors="replace")
                state = (path / "stat").read_text().rpartition(")")[2].split()[0]
            except OSError:
                continue
            if state not in "ZX":
                found[int(path.name)] = _what(words)
        return found

    def leftovers(self) -> list[str]:
        """Rooms of killed commands."""
        rooms = [*self.tmp.iterdir(), *self.where.rglob(".*.part")]
        return [str(path.relative_to(self.where)) for path in rooms]


def _what(words: str) -> str:
    if "resource_tracker" in words:
        return "tracker"
    if "multiprocessing" in words:
        return "worker"
    if "examiner" in words or "diagnose\0samples.parquet" in words:
        return "diagnosis"
    return "parent"


def kill(
    place: Place, command: subprocess.Popen[str], after: float, number: int, wanted: str
) -> str:
    """Wait and send a signal; the victim, the command itself where there is no such process."""
    time.sleep(after)
    victims = [pid for pid, what in place.processes().items() if what == wanted]
    if command.poll() is not None:
        return NOBODY
    pid, victim = (random.choice(victims), wanted) if victims else (command.pid, "parent")
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return NOBODY
    return victim


def trial(place: Place, whole: dict[str, str], seconds: float, tally: Tally) -> None:
    """One kill, and what must hold after it."""
    number, wanted = random.choice(SIGNALS), random.choice(VICTIMS)
    if place.kind.name in ("run", "diagnose"):
        wanted = "parent"
    after = random.uniform(0.0, seconds)
    what = f"{place.kind.name}: {number.name} to {wanted} after {after:.2f} s"

    def fault(text: str) -> None:
        said = (place.where / "said").read_text(errors="replace")[-2000:]
        tally.faults.append(f"{what}: {text}\n{said}")

    process = place.start()
    victim = kill(place, process, after, number, wanted)
    tally.kills += victim != NOBODY
    tally.hit[f"{number.name} {victim}"] += 1
    code = process.wait(PATIENCE)
    tally.codes[code] += 1
    ended = time.monotonic()
    while left := place.processes():
        if time.monotonic() > ended + GONE:
            fault(f"processes are left: {left}")
            for pid in left:
                os.kill(pid, signal.SIGKILL)
            break
        time.sleep(0.05)
    early = -number if number != signal.SIGKILL and victim == "parent" else 0
    expected = {0, 1, -number if number == signal.SIGKILL else 128 + number, early}
    if code not in expected:
        fault(f"exit code {code}")
    if number != signal.SIGKILL and victim == "parent" and place.leftovers():
        fault(f"a command that could clean up left {place.leftovers()}")
    tally.left += bool(place.leftovers())
    again = () if place.kind.resumes or not place.out.exists() else ("--force",)
    if place.out.exists() and not place.kind.resumes and digests(place.out, place.kind) != whole:
        fault("the output is there, but not whole")
    code = place.start(*again).wait(PATIENCE)
    if code:
        fault(f"the next command ends with {code}")
    elif (found := digests(place.out, place.kind)) != whole:
        names = {k for k in {*found, *whole} if found.get(k) != whole.get(k)}
        fault(f"other bytes than undisturbed: {sorted(names)}")
    if place.leftovers():
        fault(f"the next command leaves {place.leftovers()}")
    if "Traceback" in (place.where / "said").read_text(errors="replace"):
        fault("a traceback")


def prepared(where: Path) -> Path:
    """A log and an extended model."""
    inputs = where / "inputs"
    inputs.mkdir()
    words = ["run", "--controller", "search", "--minutes", "0.5", "--robots", "2", "--seed", "5"]
    words += ["--effect", EFFECT, "--quiet", "--out", "log"]
    subprocess.run([COMMAND, *words], cwd=inputs, check=True)
    diagnose = ["diagnose", "log", "--quiet", "--out", "model"]
    subprocess.run([COMMAND, *diagnose], cwd=inputs, check=True)
    return inputs


class Battery:
    """The kills of every kind, mixed, so that a battery that is stopped has some of each."""

    def __init__(self, where: Path, inputs: Path) -> None:
        self.where, self.inputs = where, inputs
        self.tallies: dict[str, Tally] = {}
        self.whole: dict[str, tuple[dict[str, str], float]] = {}

    def undisturbed(self, kind: Kind) -> tuple[dict[str, str], float]:
        """A kind's output when nobody kills it, and how long it took (s)."""
        if kind.name not in self.whole:
            place = Place(self.where / f"{kind.name}-whole", self.inputs, kind)
            began = time.monotonic()
            assert place.start().wait(PATIENCE) == 0, (place.where / "said").read_text()
            seconds = time.monotonic() - began
            self.whole[kind.name] = digests(place.out, kind), seconds
        return self.whole[kind.name]

    def kill(self, kind: Kind, index: int) -> None:
        """One kill."""
        tally = self.tallies.setdefault(kind.name, Tally())
        whole, seconds = self.undisturbed(kind)
        place = Place(self.where / f"{kind.name}-{index}", self.inputs, kind)
        trial(place, whole, seconds, tally)
        shutil.rmtree(place.where)

    def say(self) -> bool:
        """Print all tallies; whether there was no fault."""
        for name, tally in sorted(self.tallies.items()):
            _say(f"{name}: {tally.kills} kills, {len(tally.faults)} faults")
            _say(f"  the next command had something to clear after {tally.left}")
            _say(f"  hit: {dict(sorted(tally.hit.items()))}")
            _say(f"  exit codes: {dict(sorted(tally.codes.items()))}")
            for text in tally.faults:
                _say(f"  FAULT {text}")
        return not any(tally.faults for tally in self.tallies.values())


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main() -> None:
    """Kill, and say what came of it; the exit code is 1 after any fault."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", nargs="+", default=[f"{kind.name}=2" for kind in KINDS])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=600.0, help="stop after so long")
    asked = parser.parse_args()
    counts = {name: int(count) for name, count in (word.split("=") for word in asked.kills)}
    random.seed(asked.seed)
    for number in SIGNALS[:3]:  # a shell lets what runs in the background ignore interrupts
        signal.signal(number, signal.default_int_handler)
    todo = [(kind, index) for kind in KINDS for index in range(counts.get(kind.name, 0))]
    random.shuffle(todo)
    end = time.monotonic() + 60.0 * asked.minutes
    with TemporaryDirectory(prefix="kills-") as folder, suppress(KeyboardInterrupt):
        battery = Battery(Path(folder), prepared(Path(folder)))
        for done, (kind, index) in enumerate(todo, start=1):
            if time.monotonic() > end:
                break
            battery.kill(kind, index)
            if done % 10 == 0:
                _say(f"after {done} of {len(todo)} kills")
                battery.say()
    sys.exit(0 if battery.say() else 1)


if __name__ == "__main__":
    main()
