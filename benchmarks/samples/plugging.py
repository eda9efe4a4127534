"""Taught plugs, the looks of one plug, turns of a gripper, and the force curves of insertions."""

import shutil
from pathlib import Path

import numpy as np

from benchmarks.samples.poses import write_json
from tests.rigs.antenna import exact_cell
from tests.rigs.antenna.curves import Shape, as_csv, curve
from tests.rigs.antenna.plugging_files import (
    cell_entries,
    look_entries,
    teach_content,
)

CONNECTORS = Path(__file__).parents[2] / "config" / "connectors"
_PINS, _HOLES = "micro-d-15-pins.toml", "micro-d-15-holes.toml"
_SHAPES = {"seated": Shape(), "bent-pin": Shape(pin_n_per_mm=115, pin_mm=(-4.4, 0.5))}


def write_plugging(folder: Path) -> None:
    """The files of ``plan-plug``, ``judge-insertion``, ``calibrate plug`` and ``tool-turn``."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in (_PINS, _HOLES):
        shutil.copy(CONNECTORS / name, folder / name)
    write_json(folder / "teach.json", teach_content())
    trial = {
        **cell_entries(),
        "connector": _PINS,
        "looks": look_entries(exact_cell.looks()),
        # What ``calibrate plug`` makes of the taught plugs.
        "correction": "plug-correction.json",
    }
    write_json(folder / "trial.json", trial)
    angles = range(0, 360, 45)
    turns = [
        {
            "a6_deg": angle,
            "position_mm": [3 + np.cos(np.radians(angle)), float(np.sin(np.radians(angle)))],
        }
        for angle in angles
    ]
    write_json(folder / "turn.json", {"turns": turns})
    for name, shape in _SHAPES.items():
        text = as_csv(curve(shape))
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")
