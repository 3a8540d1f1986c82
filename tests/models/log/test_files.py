"""What every file with a schema refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from realitygap.embedded_sim.errors import InputError
from realitygap.models.log.formats.mapped import read_map
from realitygap.models.naming.health.reference import read_reference
from realitygap.models.naming.health.senses import read_sense_reference
from tests.helpers import ROOT
from tests.models.nested import leaves, replaced

REFERENCES = ROOT / "models" / "naming" / "health" / "references" / "pybullet"


def short(values: dict[str, Any]) -> dict[str, Any]:
    """A reference with one of its terms."""
    tables = {name for name in values if name in ("terms", "structure")}
    return values | {name: dict(list(values[name].items())[:1]) for name in tables}


@pytest.mark.parametrize(
    ("file", "read"),
    [("e-puck.json", read_reference), ("e-puck.senses.json", read_sense_reference)],
)
@pytest.mark.parametrize("value", [True, "1"])
def test_what_is_no_number_is_refused_wherever_a_reference_has_one(
    tmp_path: Path, file: str, read: Any, value: object
) -> None:
    sound, path = short(json.loads((REFERENCES / file).read_text())), tmp_path / "r.json"
    path.write_text(json.dumps(sound))
    read(path)
    numbers = [keys for keys, found in leaves(sound) if isinstance(found, int | float)]
    assert len(numbers) > 20
    for keys in numbers:
        path.write_text(json.dumps(replaced(sound, keys, value)))
        with pytest.raises(InputError):
            read(path)


@pytest.mark.parametrize("value", ["true", '"1"'])
def test_what_is_no_number_is_no_scale_of_a_map(tmp_path: Path, value: str) -> None:
    path = tmp_path / "map.toml"
    path.write_text(f'[columns]\nx = {{ from = "x", unit = "m", scale = {value} }}\n')
    with pytest.raises(InputError, match=r"columns\.x"):
        read_map(path)
