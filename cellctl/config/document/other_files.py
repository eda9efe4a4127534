"""Tells drawings, models and scenarios from a cell file, whose keys they would be said to lack."""

from collections.abc import Mapping
from typing import Any

_KINDS = {
    "taught": "the scenario of a fake cell",
    "like": "the scenario of a fake cell",
    "hole": "the drawing of a part with its holes",
    "contact": "the drawing of a connector",
    "mark": "the drawing of marks",
    "fixtures": "the model of a cell",
    "approaches": "the model of a cell",
}
"""By a key that such a file has, and that no cell file knows; scenarios have contacts, too."""
_OF_A_CELL = ("plc", "data_dir", "recipes", "processes")


def other_kind(raw: Mapping[str, Any]) -> str:
    """What a file is in place of a cell file; empty where it may be one."""
    if any(key in raw for key in _OF_A_CELL):
        return ""
    return next((kind for key, kind in _KINDS.items() if key in raw), "")
