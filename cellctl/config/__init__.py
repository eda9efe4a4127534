"""The cell file: one TOML per cell, parsed to frozen models, every error reported at once.

Devices stand in sections by kind, each with a name; recipes name the process that carries them out
and are checked by the model that this process brings.
"""

from cellctl.config.cell import CellConfig
from cellctl.config.commissioning import problems_before_commissioning
from cellctl.config.issue import ConfigIssue
from cellctl.config.load import load_cell, problems

__all__ = ["CellConfig", "ConfigIssue", "load_cell", "problems", "problems_before_commissioning"]
