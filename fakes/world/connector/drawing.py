"""The two kinds of 15-pin connectors that the fake world has.

Frame of a connector: z points out of its mating face, x along its rows, y from the row of seven
to the row of eight. The origin lies in the middle of both rows; its height is that where the full
section of the pins begins below their chamfers, or of the face with the holes. So a pin that is off
its hole stands on the face where both origins have the same height.

Seen from its front a plug has contact 1 on the left of the row of eight, a socket has it on the
right: both mate when the plug is turned by half a turn about y (``SOCKET_T_MATED_PLUG``).
"""

from dataclasses import dataclass
from typing import Final, Literal

from scipy.spatial.transform import RigidTransform, Rotation

ContactKind = Literal["pins", "holes"]
Colour = tuple[float, float, float]
"""Reflected share of red, green and blue light."""

SOCKET_T_MATED_PLUG: Final = RigidTransform.from_rotation(
    Rotation.from_euler("y", 180, degrees=True)
)
"""Plug over socket where both origins meet."""


@dataclass(frozen=True, slots=True)
class ConnectorDrawing:
    """Nominal sizes of a plug and its socket, in metres."""

    name: str
    pitch_m: float
    row_distance_m: float
    pin_diameter_m: float
    pin_length_m: float
    """What stands out of the insulator."""
    bore_play_m: float
    """Radial play of a pin in its bore."""
    capture_m: float
    """Offset at the face up to which the funnel still takes a pin."""
    funnel_m: float
    """Depth of the funnel."""
    spring_begin_m: float
    """Depth at which the contact springs begin to open."""
    seat_m: float
    """Depth at which the shells meet."""
    insulator_m: tuple[float, float, float]
    """Long side, short side and height of the D-shaped insulator."""
    shell_m: float
    """Thickness of the shell round the insulator."""
    shell_over_tips_m: float
    """Height of the plug's shell over the tips of its pins."""
    insulator_colour: Colour

    def positions_m(self, kind: ContactKind) -> dict[str, tuple[float, float]]:
        """Nominal places of the contacts 1 to 15, in the connector's own frame."""
        # A socket is a plug in a mirror: contact 1 has to meet hole 1.
        sign = 1.0 if kind == "pins" else -1.0
        upper = [(sign * self.pitch_m * (k - 3.5), self.row_distance_m / 2) for k in range(8)]
        lower = [(sign * self.pitch_m * (k - 3.0), -self.row_distance_m / 2) for k in range(7)]
        return {str(k): place for k, place in enumerate((*upper, *lower), start=1)}

    @property
    def bore_m(self) -> float:
        """Diameter of a hole below its funnel."""
        return self.pin_diameter_m + 2 * self.bore_play_m

    @property
    def hole_m(self) -> float:
        """Diameter of a hole at the face, where its funnel begins."""
        return self.pin_diameter_m + 2 * self.capture_m


MICRO_D_15: Final = ConnectorDrawing(
    name="micro-d-15",
    pitch_m=1.27e-3,
    row_distance_m=1.09e-3,
    pin_diameter_m=0.5e-3,
    pin_length_m=3.0e-3,
    bore_play_m=0.03e-3,
    capture_m=0.20e-3,
    funnel_m=0.25e-3,
    spring_begin_m=0.5e-3,
    seat_m=2.5e-3,
    insulator_m=(12.0e-3, 3.9e-3, 3.4e-3),
    shell_m=0.5e-3,
    shell_over_tips_m=0.6e-3,
    insulator_colour=(0.06, 0.15, 0.42),
)
"""Two rows, 8 + 7, blue insulator; the pitch is that of the micro-D class (MIL-DTL-83513). Funnel,
play and springs are assumed."""

D_SUB_15: Final = ConnectorDrawing(
    name="d-sub-15",
    pitch_m=2.77e-3,
    row_distance_m=2.84e-3,
    pin_diameter_m=1.0e-3,
    pin_length_m=5.0e-3,
    bore_play_m=0.03e-3,
    capture_m=0.30e-3,
    funnel_m=0.40e-3,
    spring_begin_m=1.0e-3,
    seat_m=4.5e-3,
    insulator_m=(24.0e-3, 7.6e-3, 5.6e-3),
    shell_m=0.5e-3,
    shell_over_tips_m=0.8e-3,
    insulator_colour=(0.38, 0.11, 0.07),
)
"""Two rows, 8 + 7, red-brown insulator; pins, pitch and rows are those of the D-sub family
(DIN 41652). Funnel, play and springs are assumed."""

DRAWINGS: Final = {drawing.name: drawing for drawing in (MICRO_D_15, D_SUB_15)}
