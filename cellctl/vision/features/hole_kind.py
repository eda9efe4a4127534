"""The appearance of a kind of hole, and what it demands of the search and of the rim fit."""

from dataclasses import dataclass
from typing import ClassVar, Protocol

from cellctl.vision.features.hole import Hole


@dataclass(frozen=True, slots=True)
class SecondEdge:
    """Prior knowledge of a second edge round a rim, such as that of a chamfer."""

    width: float
    """Distance between both edges over the radius of the rim."""
    sigma: float
    """Standard deviation of ``width``."""


class RimEvidence(Protocol):
    """The evidence of both images of a rim that has been fitted with one edge."""

    @property
    def hole(self) -> Hole:
        """The hole as the drawing gives it."""

    @property
    def clear_px(self) -> tuple[float, float]:
        """Distance to the next edge outside the rim, left and right; infinite when none is near."""

    def in_radii(self, length_px: float, image: int = 0) -> float:
        """A length in one image (0 left, 1 right) over the radius of the rim there."""

    def arcs_left_out(self) -> bool:
        """Whether arcs that are off the circle have left the fit of an image."""

    def both_converged(self) -> bool:
        """Whether the fits of both images settled."""

    def ring_gains(self) -> tuple[float, float]:
        """Fall of chi square, left and right, if a narrow ring of another grey were modelled."""

    def ring_seen(self) -> bool:
        """Whether a narrow ring explains more than chance in at least one image."""

    def uneven_inside(self) -> bool:
        """Whether the inside is uneven by more than chance in at least one image."""


class HoleKind:
    """One kind of hole. The attributes are those of a plain dark bore unless a kind says otherwise.

    A kind holds no state: ``cellctl.vision.features.known_kinds`` has one instance of each.
    """

    name: ClassVar[str]
    """Name of the kind in the feature file."""
    bright: ClassVar[bool] = False
    """The feature is brighter than what surrounds it."""
    cone: ClassVar[bool] = False
    """The surface round the rim is a cone. Its grey varies with the azimuth instead of evenly over
    the image, it has no lay, and it ends at an edge that must be kept out of the fit."""
    turns: ClassVar[bool] = False
    """Inside the rim are the turns of a thread."""
    may_show_wall: ClassVar[bool] = True
    """A wall may be seen below the rim."""
    face_begins_radii: ClassVar[float] = 1.0
    """From this radius on, in radii of the rim, the flat face of the part is seen."""
    first_ring_px: ClassVar[float | None] = None
    """Width of a ring that the very first fit must already cover; None when none is expected."""
    lends_blur: ClassVar[bool] = True
    """The blur of the image can be read off its rim. Other kinds are measured last and are told
    the blur that the rims before them have shown."""

    def second_edge(self, evidence: RimEvidence) -> SecondEdge | None:
        """The second edge that must be fitted together with the rim; None when one edge does."""
