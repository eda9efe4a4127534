"""Where the model of a cell lies that offline planning reads, and where it says that arms stand."""

import tomllib
from collections.abc import Mapping
from pathlib import Path

from pydantic import BaseModel, ValidationError

from cellctl.config.base import WrittenPose
from cellctl.files.hand_written import read_hand_written


class _Arm(BaseModel):
    cell_T_base: WrittenPose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class _Arms(BaseModel):
    robots: dict[str, _Arm] = {}


def model_path(cell_file: Path) -> Path:
    """``deck.model.toml`` beside ``deck.toml``."""
    return cell_file.with_suffix(".model.toml")


def stated_bases(cell_file: Path) -> Mapping[str, WrittenPose]:
    """``cell_T_base`` of each robot in the model of a cell file; empty where there is no model, or
    one that planning would refuse."""
    try:
        raw = tomllib.loads(read_hand_written(model_path(cell_file)))
        arms = _Arms.model_validate(raw)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, ValidationError):
        return {}
    return {name: arm.cell_T_base for name, arm in arms.robots.items()}
