"""The keys of a model file."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from cellctl.config.base import Millimetres, Section, WrittenPose
from cellctl.config.devices import DeviceName

NO_SHIFT: WrittenPose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
Point = tuple[Millimetres, Millimetres, Millimetres]
Size = Annotated[float, Field(ge=0.1, le=20_000, allow_inf_nan=False)]
Margin = Annotated[float, Field(ge=0.0, le=500.0, allow_inf_nan=False)]
DegreesPerSecond = Annotated[float, Field(gt=0.0, le=1000.0)]
SixSpeeds = tuple[
    DegreesPerSecond,
    DegreesPerSecond,
    DegreesPerSecond,
    DegreesPerSecond,
    DegreesPerSecond,
    DegreesPerSecond,
]


class CapsuleKeys(Section):
    """A ball that was swept along a line."""

    from_mm: Point
    to_mm: Point
    radius_mm: Size


class BoxKeys(Section):
    """A box about the origin of its frame."""

    size_mm: tuple[Size, Size, Size]
    at: WrittenPose = NO_SHIFT
    """The middle of the box in the frame of what it belongs to."""


class MeshKeys(Section):
    """A closed surface in a file, STL or any other that trimesh reads."""

    file: str
    """Relative to the model file."""
    unit: Literal["mm", "m"] = "mm"
    """Unit of the figures in the file, which STL does not say."""
    at: WrittenPose = NO_SHIFT


class BodyKeys(Section):
    """One rigid body with one shape."""

    capsule: CapsuleKeys | None = None
    box: BoxKeys | None = None
    mesh: MeshKeys | None = None
    stand_in: bool = False
    """A guess in place of a drawing or a measurement; `cellctl plan` says which ones these are."""

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        if sum(shape is not None for shape in (self.capsule, self.box, self.mesh)) != 1:
            raise ValueError("needs exactly one of capsule, box, mesh")
        return self


class LinkBodyKeys(BodyKeys):
    """A body that an arm moves."""

    link: Annotated[int, Field(ge=0, le=6)] = 6
    """In whose frame it is written: 0 the base, 6 the flange, else that of the D-H table."""


class ArmKeys(Section):
    """A robot of the cell file: where it stands, what it consists of and carries."""

    cell_T_base: WrittenPose = NO_SHIFT
    margin_mm: Margin
    """What stays free around it: its uncertainty, cables, and what a stop leaves its way by."""
    rated_deg_s: SixSpeeds
    """Speeds of the joints at 100 %."""
    bodies: Annotated[dict[DeviceName, LinkBodyKeys], Field(min_length=1)]


class ApproachKeys(Section):
    """Two bodies that a process brings together on purpose."""

    bodies: tuple[str, str]
    clearance_mm: Annotated[float, Field(ge=-50.0, le=500.0)]
    """What stays between them in moves that the process calls an approach; below 0 they may meet,
    as deck and frame do."""


class ModelDocument(Section):
    """The whole file. Poses of fixtures and arms are in the frame of the cell."""

    robots: Annotated[dict[DeviceName, ArmKeys], Field(min_length=1)]
    fixtures: dict[DeviceName, BodyKeys] = Field(default_factory=dict)
    """What never moves: parts in their station, tables, fences, keep-out spaces of cables."""
    approaches: tuple[ApproachKeys, ...] = ()
