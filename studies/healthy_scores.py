"""How scores are distributed in healthy logs, against the normal tails that they are named by.

    realitygap run --controller search --minutes 2 --seed 9011 --out out/healthy/h9011   # and so on
    python -m realitygap.studies.healthy_scores out/healthy/* --out docs/healthy-scores.png

A diagnosis tells how many standard deviations from health the strongest term of a robot lies. Were
that a normal variable, 2.7 of 1000 would lie beyond three. The figure shows what
healthy robots of other runs than the reference's do, term by term and robot by robot.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import seaborn as sns
import typer
from matplotlib.figure import Figure
from scipy import stats

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.measure import strength
from realitygap.models.identify.screen import glance
from realitygap.models.identify.tracks import cut_tracks
from realitygap.models.modelfile import ModelFile, read_model_file
from realitygap.models.reference import Reference, shipped_reference
from realitygap.studies.diagnosis_files import read_logs

DPI = 100
TAILS = (2.0, 3.0, 4.0, 4.5)
"""Standard deviations beyond which shares are told."""


def distances(path: Path, model: ModelFile, reference: Reference) -> FloatArray:
    """(terms, robots) signed standard deviations from health, of terms that grow in proportion."""
    tracks = cut_tracks(read_logs((path,), model), model)
    base = [reference.motion(model.motion(robot)) for robot in tracks.robots]
    rows = []
    for one in glance(Problem(tracks, base)):
        k = int(np.argmax(np.abs(one.unit)))
        parameter = one.term.cause.parameters[k]
        small = abs(one.unit[k]) <= parameter.step and np.isfinite(parameter.null)
        if one.term.cause.smooth and small:
            unit = float(strength(one.term, one.unit[None], tracks.commands)[0, k])
            mean, sd = reference.spread(one.term.key, len(one.unit))
            away = one.dose * unit - mean[k]
            rows.append(away / np.hypot(one.error * unit, np.hypot(sd[k], parameter.elsewhere)))
    return np.array(rows)


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


def main(words: Sequence[str] | None = None) -> None:
    """Read the logs, draw the figure, print shares beyond some distances."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("log", nargs="+", type=Path)
    parser.add_argument("--out", required=True, type=Path)
    options = parser.parse_args(words)
    model = read_model_file("epuck")
    reference = shipped_reference(model.name)
    assert reference is not None
    found = np.array([distances(path, model, reference) for path in options.log])
    draw(found, options.out)
    number = found.size
    for tail in TAILS:
        share = float((np.abs(found) > tail).mean())
        usual = 2.0 * stats.norm.sf(tail)
        typer.echo(f"beyond {tail:g}: {share:.5f} of {number}; normal {usual:.5f}")
    typer.echo(f"standard deviation {found.std():.3f}, largest {np.abs(found).max():.2f}")


if __name__ == "__main__":
    main()
