"""What a reader must know beside a claim: what it owes to choices that were not the paper's."""

from __future__ import annotations

from dataclasses import dataclass

from realitygap.studies.paper.weighing import ABOVE_ONE, BELOW_ONE


@dataclass(frozen=True)
class Note:
    """Said once in full, and beside every claim it concerns by its label."""

    label: str
    text: str
    claims: tuple[str, ...] = ()
    """Keys of the claims concerned."""


LAMP = Note(
    "lamp chosen for this order",
    "The paper gives no figure for its lamp. Ours fades at 0.8 m because ranges of 0.6 to 1 m gave "
    "the paper's order of conditions. That order is therefore no independent finding.",
    (
        *("no-light-worst", "two-best", "light-useful", "opposite-marginal", "negative-excels"),
        *("switches-below-fixed", "first-half-better", "balanced", "opposite-fails"),
        *("keeps-foraging-at-nest-to-opposite", "keeps-foraging-opposite-to-at-nest"),
        *("retrieval-falls-at-nest", "spread-grows-opposite-to-at-nest"),
    ),
)
MUTATION = Note(
    "s.d. 0.2, not 2",
    "S0 mutates with a standard deviation of 0.2; the paper prints 2, on genes of range 1. What "
    "that changes was judged by three runs of ten minutes of each variant only.",
    (
        *("two-best", "nest-converges-faster", "spread-falls-no-light", "spread-falls-at-nest"),
        *("spread-grows-opposite-to-at-nest", "mean-middle-no-light", "mean-middle-opposite"),
        *("no-light-converges", "opposite-fails", "nest-converges", "nest-mean-upper"),
        *("nest-positive", "search-evolves-no-light", "search-evolves-opposite"),
        *("first-half-opposite", "first-half-nest"),
        *("persists-at-nest-to-opposite", "persists-opposite-to-at-nest"),
    ),
)
POOLED = Note(
    "same first halves pooled",
    "Until the lamp moves, at nest → opposite is the same experiment as light at nest, and "
    "opposite → at nest the same as light opposite. Claims about the first half alone pool their "
    "runs.",
    ("nest-converges-faster", "first-half-opposite", "first-half-nest"),
)
STAND_IN = Note(
    "stand-in",
    "A study keeps no positions. Seclusion is judged by how many others a robot hears.",
    ("segregation",),
)
ANY_DIFFERENCE = Note(
    "any difference counts",
    "The paper names no size, and none was set beforehand: however small a difference in the "
    "claimed direction, it would count, whether or not it matters to anyone.",
)
NOTES = (LAMP, MUTATION, POOLED, STAND_IN, ANY_DIFFERENCE)

ANY = (ABOVE_ONE, BELOW_ONE, (float("-inf"), 0.0))
"""Ranges that begin at no difference at all."""


def labels(claim: str, region: tuple[float, float]) -> list[str]:
    """Labels of the notes that stand beside a claim.

    Args:
        claim: Its key.
        region: Effects for which it holds.
    """
    concerned = [note.label for note in NOTES if claim in note.claims]
    return [*concerned, *([ANY_DIFFERENCE.label] if region in ANY else [])]
