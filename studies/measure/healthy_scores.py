"""How scores are distributed in healthy logs, against the normal tails that they are named by.

    realitygap run --controller search --minutes 2 --seed 9011 --out out/healthy/h9011   # and so on
    realitygap measure healthy-scores out/healthy/* --out docs/healthy-scores.png --force

A diagnosis tells how many standard deviations from health the strongest term of a robot lies. Were
that a normal variable, 2.7 of 1000 would lie beyond three. The figure shows what
healthy robots of other runs than the reference's do, term by term and robot by robot.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import seaborn as sns
from matplotlib.figure import Figure
from scipy import stats

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile, read_model_file
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.channels.motion.tracks import cut_tracks
from realitygap.models.naming.engine.seen import scores
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.health.reference import Reference, shipped_reference
from realitygap.studies.inputs.logs import read_logs
from realitygap.studies.plumbing.output import whole_file

DPI = 100
TAILS = (2.0, 3.0, 4.0, 4.5)
"""Standard deviations beyond which shares are told."""


def distances(path: Path, model: ModelFile, reference: Reference) -> FloatArray:
    """(terms, robots) signed standard deviations from health, of terms that grow in proportion."""
    tracks = cut_tracks(read_logs(path, model), model)
    base = tuple(reference.motion(model.motion(robot)) for robot in tracks.robots)
    robots = tuple(robots_of(tracks, base, doses=False))
    return np.array(list(scores(Weighed(State(tracks, base, robots, reference.learned))).values()))


def draw(found: FloatArray, path: Path) -> None:
    """Histogram of (logs, terms, robots) distances beside the normal density, and of the largest
    of each robot."""
    sns.set_theme(style="whitegrid", font_scale=0.85)
    figure = Figure(figsize=(9, 3.2), layout="constrained")
    every, largest = figure.subplots(1, 2)
    x = np.linspace(-5.0, 5.0, 201)
    sns.histplot(found.ravel(), bins=50, stat="density", ax=every, color="#4878a8")
    every.plot(x, stats.norm.pdf(x), color="#222222", label="normal")
    every.set(xlabel="standard deviations from health, every term", yscale="log", ylim=(1e-4, 1))
    every.legend()
    most = np.abs(found).max(axis=1).ravel()
    z, terms = np.linspace(0.0, 5.0, 201), found.shape[1]
    sns.histplot(most, bins=30, stat="density", ax=largest, color="#4878a8")
    density = terms * 2 * stats.norm.pdf(z) * (2 * stats.norm.cdf(z) - 1) ** (terms - 1)
    largest.plot(z, density, color="#222222", label=f"largest of {terms} normal")
    largest.set(xlabel="the largest of each robot", ylabel="")
    largest.legend()
    figure.savefig(path, dpi=DPI, metadata={"Software": ""})


def healthy_scores(logs: Sequence[Path], out: Path, *, force: bool = False) -> list[str]:
    """Read logs of healthy e-pucks, draw how far from health they seem.

    Args:
        logs: Runs of the same number of robots.
        out: The figure (PNG).
        force: Replace a figure that is there.

    Returns:
        Shares beyond some distances, in lines.

    Raises:
        InputError: a log cannot be read, or `out` cannot be written.
    """
    with whole_file(out, force=force) as part:
        model = read_model_file("epuck")
        reference = shipped_reference(model.name)
        assert reference is not None
        found = np.array([distances(path, model, reference) for path in logs])
        draw(found, part)
    lines = []
    for tail in TAILS:
        share = float((np.abs(found) > tail).mean())
        usual = 2.0 * stats.norm.sf(tail)
        lines.append(f"beyond {tail:g}: {share:.5f} of {found.size}; normal {usual:.5f}")
    spread, most = found.std(), np.abs(found).max()
    return [*lines, f"standard deviation {spread:.3f}, largest {most:.2f}"]
