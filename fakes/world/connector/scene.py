"""What a camera sees of connectors and of the marks on a gripper: hand-over to the renderer.

Everything is truth, in SI units, as in ``fakes.world.scene``; z of every body points towards the
camera.
"""

from dataclasses import dataclass
from typing import Literal

from scipy.spatial.transform import RigidTransform

from fakes.world.connector.drawing import Colour, ConnectorDrawing, ContactKind

Tip = Literal["chamfer", "dome"]


@dataclass(frozen=True, slots=True)
class SceneContact:
    """One pin or one hole as it was really made, in the frame of its connector."""

    name: str
    root_m: tuple[float, float]
    """Place where a pin leaves the insulator, or middle of a hole."""
    bend_m: tuple[float, float] = (0.0, 0.0)
    """Offset of the tip from its root."""
    present: bool = True
    """False where the pin is missing or the hole was not made."""
    blocked: bool = False
    """A hole with something in it."""
    shine: float = 1.0
    """Brightness relative to the other contacts."""

    @property
    def centre_m(self) -> tuple[float, float]:
        """The tip of a pin, the middle of a hole: what an image measures."""
        return self.root_m[0] + self.bend_m[0], self.root_m[1] + self.bend_m[1]


@dataclass(frozen=True, slots=True)
class SceneDirt:
    """A flat speck; its outline is a circle with two waves."""

    position_m: tuple[float, float, float]
    radius_m: float
    waves: tuple[float, float]
    """Relative height of the waves two and three times round."""
    turn_rad: float
    level: float
    """Reflected share of the light."""
    opacity: float


@dataclass(frozen=True, slots=True)
class SceneConnector:
    """Plug or socket on its housing or panel."""

    name: str
    kind: ContactKind
    camera_T_connector: RigidTransform
    drawing: ConnectorDrawing
    contacts: tuple[SceneContact, ...]
    housing_m: tuple[float, float]
    """Sides of the face that carries the connector."""
    tip: Tip
    dirt: tuple[SceneDirt, ...]
    seed: int
    """Seed of the housing's texture."""


@dataclass(frozen=True, slots=True)
class SceneMark:
    """A white disc on a dark plate, in the plane z = 0 of its body."""

    name: str
    position_m: tuple[float, float]
    diameter_m: float


@dataclass(frozen=True, slots=True)
class SceneMarks:
    """Two dark plates with white discs, one on each finger of the gripper, in one plane."""

    name: str
    camera_T_marks: RigidTransform
    plates_m: tuple[tuple[float, float, float, float], ...]
    """Middle x, y and sides along x and y of each plate."""
    marks: tuple[SceneMark, ...]


ConnectorBody = SceneConnector | SceneMarks

BARE_METAL: Colour = (0.62, 0.61, 0.58)
"""Housing, panel and shell: hardly any saturation, unlike the insulator."""
GOLD: Colour = (0.95, 0.78, 0.42)
WHITE: Colour = (0.85, 0.85, 0.83)
BLACK: Colour = (0.035, 0.035, 0.035)
