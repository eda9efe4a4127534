"""What one image says about a connector."""

from dataclasses import dataclass
from typing import Literal

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.faults.connector import (
    ContactBent,
    ContactHidden,
    ContactMissing,
)

Method = Literal["default", "paper"]
ContactState = Literal["ok", "missing", "bent", "hidden"]
BAD_CONTACTS = (ContactMissing, ContactBent, ContactHidden)
"""What ``require_sound`` raises."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredContact:
    """One contact of the drawing."""

    name: str
    state: ContactState
    px: Array
    """Where it is in the raw image; of a contact that was not found, where it should be."""
    covariance_px2: Array | None
    """Shape (2, 2); None for a contact that was not found."""
    residual_m: Array | None
    """Measured less fitted, x and y in the axes of the drawing."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredMarks:
    """The gripper's marks in the same image."""

    camera_T_marks: UncertainPose
    px: Array
    """Shape (n, 2)."""
    radius_px: float
    """Radius, for the picture only."""
    scale: float
    """Size of the pattern against its drawing, left free as a check."""

    @property
    def camera_T_marks_by_size(self) -> RigidTransform:
        """The marks as far from the camera as they look large, along the ray to them.

        Drilled holes are off their places by hundredths of a millimetre, which is a tenth in
        distance: compare two pictures of the same marks, whose difference is good to 0.02 mm.
        """
        pose = self.camera_T_marks.pose
        return RigidTransform.from_components(pose.translation / self.scale, pose.rotation)


@dataclass(frozen=True, slots=True, eq=False)
class ConnectorMeasurement:
    """A connector in one image; x, y and yaw are measured, the rest is the plane's."""

    method: Method
    connector: str
    camera_id: str
    contacts: tuple[MeasuredContact, ...]
    radius_px: float
    """Radius of a good contact, for the picture only."""
    camera_T_connector: UncertainPose
    scale: float
    chi2: float
    freedom: int
    marks: MeasuredMarks | None = None
    warnings: tuple[str, ...] = ()

    @property
    def marks_T_connector(self) -> UncertainPose | None:
        """The plug in the gripper. Both come from one image and one plane, whose common error
        cancels; the covariance of the product is therefore on the safe side."""
        if self.marks is None:
            return None
        return self.marks.camera_T_marks.inv() * self.camera_T_connector


def require_sound(measurement: ConnectorMeasurement, *, tolerated: int = 0) -> None:
    """Raise the fault of the contacts that are not as they should be, when there are too many.

    ``ContactMissing``, ``ContactBent`` or ``ContactHidden``, with the names of all of them.
    """
    bad = [contact for contact in measurement.contacts if contact.state != "ok"]
    if len(bad) <= tolerated:
        return
    words = ", ".join(f"{contact.name} {_words(contact)}" for contact in bad)
    states = {contact.state for contact in bad}
    if "missing" in states:
        raise ContactMissing(words)
    if "bent" in states:
        raise ContactBent(words)
    raise ContactHidden(words)


def _words(contact: MeasuredContact) -> str:
    if contact.state != "bent" or contact.residual_m is None:
        return contact.state
    x_mm, y_mm = contact.residual_m / MM
    return f"bent by {x_mm:+.3f}, {y_mm:+.3f} mm"
