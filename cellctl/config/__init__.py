"""The cell file: one TOML per cell, parsed to frozen models, every error reported at once."""

from cellctl.config.cell import CellConfig
from cellctl.config.issue import Problem
from cellctl.config.load import load_cell, problems

__all__ = ["CellConfig", "Problem", "load_cell", "problems"]
