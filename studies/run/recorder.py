"""What a run leaves behind: samples streamed to Parquet, generations and deposits at the end."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from realitygap.embedded_sim import CONTROL_STEP, SENSORS
from realitygap.embedded_sim.breeding import third
from realitygap.embedded_sim.genome import Genome
from realitygap.embedded_sim.onboard import Generation
from realitygap.models.log.table_files import RECORDER

if TYPE_CHECKING:
    from realitygap.embedded_sim.model import FloatArray
    from realitygap.reality.world import World

CHUNK = 1500
"""Control steps per Parquet row group: one minute, a few MB for ten robots."""
POSITION_STEPS = round(1.0 / CONTROL_STEP)
"""Control steps between two positions of a run without samples: 1 s, in which a robot drives less
than its own diameter."""

SCENARIO_CASES = ("light-opposite-nest", "no-light", "light-at-nest")
"""Case name of each of `embedded_sim.SCENARIOS`, as the log's `case` column has it."""

_UNITS = {
    "t": "s",
    "x": "m",
    "y": "m",
    "yaw": "rad",
    "cmd_left": "rad/s",
    "cmd_right": "rad/s",
    "wheel_left": "rad/s",
    "wheel_right": "rad/s",
    **{f"{kind}{i}": "counts" for kind in ("ps", "ls") for i in range(SENSORS)},
}
_FLOATS = ("t", "x", "y", "yaw", "cmd_left", "cmd_right", "wheel_left", "wheel_right")
_COUNTS = tuple(f"{kind}{i}" for kind in ("ps", "ls") for i in range(SENSORS))


def _schema() -> Any:
    text = pa.dictionary(pa.int32(), pa.string())
    fields = [("run", text), ("robot", pa.int32())]
    fields += [(name, pa.float64()) for name in _FLOATS]
    fields += [(name, pa.uint16()) for name in _COUNTS]
    fields += [("food", pa.bool_()), ("nest", pa.bool_()), ("case", text)]
    return pa.schema(
        [
            pa.field(name, kind, metadata={"unit": _UNITS[name]} if name in _UNITS else None)
            for name, kind in fields
        ]
    )


class Experimented(Protocol):
    """What robots were told and what came of it."""

    generations: list[Generation]
    deposits: list[tuple[int, int, int, int]]
    """(robot, step, step of pick-up, generation)."""

    @property
    def commands(self) -> FloatArray:
        """(robots, 2) rad/s, left and right."""


@dataclass(frozen=True)
class RunTables:
    """The tables that fit in memory."""

    generations: pd.DataFrame
    deposits: pd.DataFrame


class Recorder:
    """Collects a run's samples a minute at a time; nothing is allocated per step."""

    def __init__(
        self, out: Path, case: str, run: str, robots: int, samples: bool, *, engine: str
    ) -> None:
        self._out, self._case, self._run = out, case, run
        self._rows = robots if samples else 0
        self._filled = 0
        self._positions: list[FloatArray] = []
        self._floats = np.empty((len(_FLOATS), CHUNK, self._rows))
        self._counts = np.empty((CHUNK, self._rows, 2 * SENSORS), dtype=np.uint16)
        self._flags = np.empty((2, CHUNK, self._rows), dtype=np.uint8)
        self._scenario = np.empty((CHUNK, self._rows), dtype=np.int32)
        self._writer: Any = None
        self._schema = _schema().with_metadata({RECORDER: f"reality {engine}".encode()})

    def __enter__(self) -> Recorder:
        if self._rows:
            self._writer = pq.ParquetWriter(
                self._out / "samples.parquet", self._schema, compression="zstd"
            )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def sample(self, step: int, world: World, swarm: Experimented, scenario: int) -> None:
        """Keep one control step: measured poses, readings, virtual sensor, commands answered.

        A row's commands hold from its time on; its wheel speeds are the encoders' steps since the
        row before. A run without samples keeps measured positions, once a second.
        """
        if not self._rows:
            if step % POSITION_STEPS == 0:
                self._positions.append(world.tracker.poses[:, :2].copy())
            return
        world.read_encoders()
        at = self._filled
        self._floats[0, at] = step * CONTROL_STEP
        self._floats[1:4, at] = world.tracker.poses.T
        self._floats[4:6, at] = swarm.commands.T
        self._floats[6:8, at] = world.encoders.speeds.T
        self._counts[at, :, :SENSORS] = world.infrared.counts
        self._counts[at, :, SENSORS:] = world.light.counts
        self._flags[0, at] = world.tracker.on_food
        self._flags[1, at] = world.tracker.on_nest
        self._scenario[at] = scenario
        self._filled += 1
        if self._filled == CHUNK:
            self._flush()

    def finish(self, swarm: Experimented, genome: Genome) -> RunTables:
        """Write what is left and the two small tables."""
        if self._filled:
            self._flush()
        if self._positions:
            self._write_positions()
        tables = RunTables(self._generations(swarm, genome), self._deposits(swarm))
        tables.generations.to_parquet(self._out / "generations.parquet", index=False)
        tables.deposits.to_parquet(self._out / "deposits.parquet", index=False)
        return tables

    def _flush(self) -> None:
        steps, self._filled = self._filled, 0
        rows = steps * self._rows
        robots = np.tile(np.arange(self._rows, dtype=np.int32), steps)
        columns: dict[str, Any] = {
            "run": pa.DictionaryArray.from_arrays(np.zeros(rows, dtype=np.int32), [self._run]),
            "robot": robots,
        }
        for i, name in enumerate(_FLOATS):
            columns[name] = self._floats[i, :steps].reshape(rows)
        for i, name in enumerate(_COUNTS):
            columns[name] = self._counts[:steps, :, i].reshape(rows)
        for i, name in enumerate(("food", "nest")):
            columns[name] = self._flags[i, :steps].reshape(rows).astype(bool)
        columns["case"] = pa.DictionaryArray.from_arrays(
            self._scenario[:steps].reshape(rows), SCENARIO_CASES
        )
        self._writer.write_table(pa.table(columns, schema=self._schema))

    def _write_positions(self) -> None:
        """A row per robot and second; to the millimetre, which takes half the room."""
        seconds, robots = len(self._positions), len(self._positions[0])
        places = np.stack(self._positions).reshape(-1, 2).round(3).astype(np.float32)
        columns = {
            "t": np.repeat(np.arange(seconds, dtype=np.float32), robots),
            "robot": np.tile(np.arange(robots, dtype=np.int32), seconds),
            "x": places[:, 0],
            "y": places[:, 1],
        }
        kept = pd.DataFrame(columns)
        kept.to_parquet(self._out / "positions.parquet", index=False, compression="zstd")

    def _generations(self, swarm: Experimented, genome: Genome) -> pd.DataFrame:
        rows = sorted(swarm.generations, key=lambda g: (g.robot, g.generation))
        fixed = [np.isnan(g.s0) for g in rows]
        constants = [genome.values(np.array(g.genome)) for g in rows]
        return pd.DataFrame(
            {
                "run": pd.Series([self._run] * len(rows), dtype="str"),
                "robot": np.array([g.robot for g in rows], dtype=np.int32),
                "generation": np.array([g.generation for g in rows], dtype=np.int32),
                "t_start": np.array([g.start_step for g in rows]) * CONTROL_STEP,
                "t_end": np.array([g.end_step for g in rows]) * CONTROL_STEP,
                "case": pd.Series([self._case] * len(rows), dtype="str"),
                "s0": np.array([g.s0 for g in rows], dtype=np.float64),
                "s0_third": pd.array(
                    [pd.NA if none else third(g.s0) for g, none in zip(rows, fixed, strict=True)],
                    dtype="Int8",
                ),
                "g0": np.array([g.genome[0] for g in rows], dtype=np.float64),
                "g1": np.array([g.genome[1] for g in rows], dtype=np.float64),
                "fitness_sim": np.array([g.fitness_sim for g in rows], dtype=np.float64),
                "fitness_real": np.array([g.fitness_real for g in rows], dtype=np.float64),
                "deposits": np.array([g.deposits for g in rows], dtype=np.int32),
                "heard": np.array([g.heard for g in rows], dtype=np.int32),
                **{
                    gene.name: np.array([values[gene.name] for values in constants])
                    for gene in genome.continuous
                },
            }
        )

    def _deposits(self, swarm: Experimented) -> pd.DataFrame:
        rows = np.array(swarm.deposits, dtype=np.int64).reshape(-1, 4)
        return pd.DataFrame(
            {
                "run": pd.Series([self._run] * len(rows), dtype="str"),
                "robot": rows[:, 0].astype(np.int32),
                "t": rows[:, 1] * CONTROL_STEP,
                "t_pickup": rows[:, 2] * CONTROL_STEP,
                "generation": rows[:, 3].astype(np.int32),
            }
        )
