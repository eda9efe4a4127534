"""Where the model of a cell lies that offline planning reads, and what it says that a cell file can
be held against: where arms stand, and bodies that are boxes."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import BaseModel, ValidationError

from cellctl.config.base import WrittenPose
from cellctl.files.hand_written import read_hand_written

_NOWHERE: WrittenPose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
FLANGE_LINK = 6
"""The link that is the flange, to which bodies belong of which nothing else is said."""


class _Box(BaseModel):
    size_mm: tuple[float, float, float]
    at: WrittenPose = _NOWHERE


class _Body(BaseModel):
    link: int = FLANGE_LINK
    box: _Box | None = None


class _Arm(BaseModel):
    cell_T_base: WrittenPose = _NOWHERE
    bodies: dict[str, _Body] = {}


class _Model(BaseModel):
    robots: dict[str, _Arm] = {}
    fixtures: dict[str, _Body] = {}


@dataclass(frozen=True, slots=True)
class ModelBox:
    """A body that is a box, as it is written."""

    key: str
    """Its place in the file, such as ``fixtures.frame``."""
    size_mm: tuple[float, float, float]
    at: WrittenPose
    """Its middle in the frame of what it belongs to."""

    @property
    def name(self) -> str:
        """Name of the file without its folder."""
        return self.key.rsplit(".", 1)[-1]


@dataclass(frozen=True, slots=True)
class StatedModel:
    """What a model file says; nothing of a cell without one, or with one that planning refuses."""

    file: str
    """Its name."""
    bases: Mapping[str, WrittenPose] = field(default_factory=dict)
    """``cell_T_base`` of each robot."""
    fixtures: tuple[ModelBox, ...] = ()
    at_flange: Mapping[str, tuple[ModelBox, ...]] = field(default_factory=dict)
    """What each robot carries at its flange."""
    boxes_alone: bool = False
    """Whether all fixtures are boxes: then ``fixtures`` has everything that stands in the cell."""


def model_path(cell_file: Path) -> Path:
    """``deck.model.toml`` beside ``deck.toml``."""
    return cell_file.with_suffix(".model.toml")


def stated_model(model: Path) -> StatedModel:
    """What a model file says."""
    try:
        raw = tomllib.loads(read_hand_written(model))
        read = _Model.model_validate(raw)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, ValidationError):
        return StatedModel(model.name)
    at_flange = {
        name: _boxes(
            f"robots.{name}.bodies",
            {key: body for key, body in arm.bodies.items() if body.link == FLANGE_LINK},
        )
        for name, arm in read.robots.items()
    }
    bases = {name: arm.cell_T_base for name, arm in read.robots.items()}
    fixtures = _boxes("fixtures", read.fixtures)
    boxes_alone = len(fixtures) == len(read.fixtures)
    return StatedModel(model.name, bases, fixtures, at_flange, boxes_alone)


def _boxes(where: str, bodies: Mapping[str, _Body]) -> tuple[ModelBox, ...]:
    return tuple(
        ModelBox(f"{where}.{name}", body.box.size_mm, body.box.at)
        for name, body in bodies.items()
        if body.box is not None
    )


def stated_bases(cell_file: Path) -> Mapping[str, WrittenPose]:
    """``cell_T_base`` of each robot in the model beside a cell file."""
    return stated_model(model_path(cell_file)).bases
