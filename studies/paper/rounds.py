"""Runs are added in batches, only to conditions whose claims are open, until nothing is.

The default reading and the mixtures come first, then the literal reading, no selection, and other
lamps. What is done next follows from the runs that are there, so a resumed study goes the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import pandas as pd

from realitygap.studies.pages.page import number
from realitygap.studies.paper.claims import CLAIMS, PAPERS
from realitygap.studies.paper.conditions import STUDIED, Condition, PlannedRun, StudyConfig, plan
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.execution import execute, run_files
from realitygap.studies.paper.readings import (
    DEFAULT,
    LAMPS,
    LITERAL,
    NEUTRAL,
    conditions_of,
    of_variant,
)
from realitygap.studies.paper.sequential import looks
from realitygap.studies.paper.tables import Known, StudyTables, collect
from realitygap.studies.paper.verdicts import OPEN, decide, still_open
from realitygap.studies.paper.weighing import Claim
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.progress import Shown

DECIDED = (DEFAULT, LITERAL, NEUTRAL, *LAMPS)
"""Variants in the order in which they are decided."""

Directory = StudyDirectory[StudyConfig, PlannedRun]


def claims_of(variant: str) -> tuple[Claim, ...]:
    """What a variant decides: the mixtures are asked about once."""
    return CLAIMS if variant == DEFAULT else PAPERS


def studied_in(variant: str) -> tuple[Condition, ...]:
    """A variant's own conditions."""
    return STUDIED if variant == DEFAULT else conditions_of(variant)


def grown(
    runs: Mapping[str, int],
    conditions: Mapping[str, Condition],
    claims: Sequence[Claim],
    batch: int,
) -> dict[str, int]:
    """How many runs each condition has when the open claims have got one batch more.

    Args:
        runs: By key of condition, so far.
        conditions: By name: where a variant has one of its own, that, else the default's.
        claims: Those that are open.
        batch: Runs that are added.

    Returns:
        As `runs`: of an open claim's conditions those with fewest runs have a batch more, unless
        they have all that may be spent.
    """
    more = dict(runs)
    for claim in claims:
        keys = {conditions[name].key for name in claim.conditions}
        fewest = min(runs[key] for key in keys)
        if fewest + batch <= looks(batch)[-1]:
            more |= {key: fewest + batch for key in keys if runs[key] == fewest}
    return more


@dataclass
class Rounds:
    """The rounds of one study."""

    directory: Directory
    workers: Workers
    report: Callable[[Directory], object]
    """Makes tables, figures and page of what is there: after every round that ran anything."""
    quiet: bool
    known: Known = field(default_factory=dict)
    runs: dict[str, int] = field(default_factory=dict)
    """So far, by key of condition."""

    def finish(self) -> None:
        """Do every round that is missing.

        Raises:
            RunsFailed: some runs raised; the others are kept.
            WorkersLost: workers keep dying.
        """
        for variant in DECIDED:
            own = studied_in(variant)
            at_hand = {one.name: one for one in (*STUDIED, *own)}
            wanted = self.runs | {one.key: self.directory.study.runs for one in own}
            while wanted != self.runs:
                tables = self._run(wanted)
                found = decide(of_variant(tables, variant), self._batch, claims_of(variant))
                self._say(variant, found)
                left = still_open(found, claims_of(variant))
                wanted = grown(self.runs, at_hand, left, self._batch)

    @property
    def _batch(self) -> int:
        return self.directory.study.runs

    def _run(self, wanted: dict[str, int]) -> StudyTables:
        """Do the runs that are missing; all that are there."""
        self.runs = wanted
        conditions = [one for name in DECIDED for one in studied_in(name) if one.key in wanted]
        self.directory.widen(plan(self.directory.study, conditions, wanted))
        if self.directory.pending():
            execute(self.directory, self.workers, run_files, quiet=self.quiet)
            self.report(self.directory)
        return collect(self.directory, self.known)

    def _say(self, variant: str, found: pd.DataFrame) -> None:
        """How many claims are decided, which are open, and how wide intervals still are."""
        with Shown("claims", None, (), quiet=self.quiet) as shown:
            left = found[found["verdict"] == OPEN]
            shown.say(f"{variant}: {len(found) - len(left)} of {len(found)} claims are decided")
            for row in left.to_dict("records"):
                shown.say(
                    f"  open: {row['claim']}, {number(row['effect'])} ({number(row['low'])} to "
                    f"{number(row['high'])}) of {row['runs']} runs, at {row['bound']:.2f} s.e."
                )


def verdicts_by_variant(tables: StudyTables, batch: int) -> dict[str, pd.DataFrame]:
    """The claims tables of all variants that have runs of their own."""
    there = set(tables.runs["variant"])
    return {
        variant: decide(of_variant(tables, variant), batch, claims_of(variant))
        for variant in DECIDED
        if variant in there
    }
