"""The cell files of config/, each read once by a worker: they are checked in full each time."""

from functools import cache
from pathlib import Path

from cellctl.config import CellConfig, load_cell

CONFIG = Path(__file__).parents[2] / "config"


@cache
def shipped_cell(name: str) -> CellConfig:
    """The cell file of that name, for all who read it and change copies alone."""
    return load_cell(CONFIG / name)
