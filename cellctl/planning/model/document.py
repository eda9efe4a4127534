"""The keys of a model file."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from cellctl.config.base import Millimetres, Section, WrittenPose
from cellctl.config.devices import DeviceName

NO_SHIFT: WrittenPose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
Point = tuple[Millimetres, Millimetres, Millimetres]
Size = Annotated[float, Field(ge=0.1, le=20_000, allow_inf_nan=False)]
Distance = Annotated[float, Field(ge=20.0, le=10_000, allow_inf_nan=False)]
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
    absent_in: frozenset[Annotated[int, Field(ge=1)]] = frozenset()
    """Numbers of the procedures before which a person takes it away."""

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
    joint_margin_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 5.0
    """What a planned pose keeps from the limits of every joint."""
    bodies: Annotated[dict[DeviceName, LinkBodyKeys], Field(min_length=1)]


class HeadKeys(Section):
    """A stereo head of the cell file: where it sees well, and what its images are like."""

    sharp_mm: tuple[Distance, Distance]
    """Nearest and farthest place in focus, along the line of sight."""
    margin_px: Annotated[float, Field(ge=10.0, le=1000.0)] = 60.0
    """Between a rim and the edge of the image: parts do not stand exactly."""
    greatest_angle_deg: Annotated[float, Field(gt=0.0, le=60.0)] = 35.0
    """Between a line of sight and the axis of a bore."""
    lit_within_deg: Annotated[float, Field(gt=0.0, le=90.0)] = 45.0
    """Between the lamp's axis and the way to a hole; the lamp sits in the middle of the head and
    shines along the middle of both lines of sight."""
    contrast_grey: Annotated[float, Field(gt=0.0, le=255.0)]
    """Step of grey across a rim of a part, the face against the dark of a bore."""
    noise_grey: Annotated[float, Field(gt=0.0, le=100.0)]
    """Standard deviation of the grey of a face, noise and texture together."""
    blur_px: Annotated[float, Field(gt=0.0, le=5.0)]

    @model_validator(mode="after")
    def _nearest_first(self) -> Self:
        if not self.sharp_mm[0] < self.sharp_mm[1]:
            raise ValueError("sharp_mm must be so: nearest < farthest")
        return self


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
    stereo_cameras: dict[DeviceName, HeadKeys] = Field(default_factory=dict)
    """Needed by `cellctl plan viewpoints` alone."""
    approaches: tuple[ApproachKeys, ...] = ()
