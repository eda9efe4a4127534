"""What was measured of a peg that may be inserted. None is unknown, and unknown is not inserted."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class LateralCapture:
    """The peg pushed to both sides along x and y, with a small force into the hole."""

    resisted: int | None
    """Directions of four in which the push was met before the end of its way; None where one was
    not pushed at all and all others have resisted."""
    play_x_m: float | None
    play_y_m: float | None
    """Way between both contacts, less what arm and contact give way; None without both, and where
    less is left than any arm makes of walls."""
    depth_change_m: float
    """Greatest change of depth meanwhile."""
    force_change_sigmas: float
    """Range of the pushed component in standard deviations of the sensor."""


@dataclass(frozen=True, slots=True)
class InsertionEvidence:
    """Evidence of one insertion; depths count from the face that was touched in this cycle."""

    depth_m: float | None
    """Depth of the tip, less the force on it divided by the stiffness."""
    seat_force_n: float | None
    seat_slope_n_m: float | None
    """Rise of the axial force over depth at the seat."""
    held_way_m: float | None
    """Way of the feed on which more than its walls and its seat have held the part back."""
    unrubbed_way_m: float | None
    """Way on which the contacts of a part should rub and were not felt; for parts with contacts."""
    with_feed_n: float | None
    """Greatest force that has acted with the feed instead of against it."""
    dropped_n: float | None
    """Greatest drop of the force in the feed that no way back explains."""
    capture: LateralCapture | None
    greatest_force_n: float | None
    """Along the axis, ever since the part was gripped."""
    grip_force_n: float | None
    """Force at which the part slips in the gripper, measured at commissioning."""
    retouch_error_m: float | None
    """After release: height of the part's rear, by a touch, less where the drawing has it."""
    keyed_directions: int | None = None
    """Directions of two in which a turn was met; for keyed parts."""
    held_pull_n: float | None = None
    """Pull that a connector has held."""

    def to_record(self) -> dict[str, Any]:
        """Plain data."""
        record = {name: getattr(self, name) for name in self.__slots__}
        capture = self.capture
        if capture is not None:
            record["capture"] = {name: getattr(capture, name) for name in capture.__slots__}
        return record


NOTHING_KNOWN = InsertionEvidence(
    depth_m=None,
    seat_force_n=None,
    seat_slope_n_m=None,
    held_way_m=None,
    unrubbed_way_m=None,
    with_feed_n=None,
    dropped_n=None,
    capture=None,
    greatest_force_n=None,
    grip_force_n=None,
    retouch_error_m=None,
)
"""Evidence of a part that nobody has inserted yet."""
