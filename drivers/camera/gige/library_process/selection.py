"""Finds the camera that the settings name among those that the producers see."""

from collections.abc import Mapping, Sequence

from harvesters.core import ImageAcquirer

from drivers.camera.gige.library_process.producers import Found
from drivers.camera.gige.library_process.trouble import (
    GENICAM_ERRORS,
    TAKEN,
    TroubleError,
    in_words,
)
from drivers.camera.gige.protocol import CameraState, SeenCamera, Trouble


def selected(
    cameras: Sequence[Found], keys: Mapping[str, str], unusable: Sequence[str] = ()
) -> Found:
    """The one camera that is known by all of these keys.

    ``unusable`` are producers that might have seen it. Raises ``TroubleError``: ``ABSENT`` for
    none, ``AMBIGUOUS`` for several, ``BUSY`` for one of another program.
    """
    label = label_of(keys)
    found = [one for one in cameras if all(getattr(one.seen, k) == v for k, v in keys.items())]
    if not found:
        there = ", ".join(_in_words(one.seen) for one in cameras) or "no camera"
        rest = "".join(f"; {text}" for text in unusable)
        raise TroubleError(Trouble.ABSENT, f"no camera with {label}; there is {there}{rest}")
    if len({(one.seen.vendor, one.seen.serial_number or one.seen.id) for one in found}) > 1:
        those = ", ".join(_in_words(one.seen) for one in found)
        raise TroubleError(Trouble.AMBIGUOUS, f"several cameras with {label}: {those}")
    # One camera may be seen by the producers of two makers, and over two interfaces.
    best = min(found, key=lambda one: list(CameraState).index(one.seen.state))
    if best.seen.state is CameraState.IN_USE:
        raise TroubleError(Trouble.BUSY, f"{label} is controlled by another program")
    return best


def opened(found: Found, label: str) -> ImageAcquirer:
    """The camera, open; raises ``TroubleError``."""
    try:
        return found.create()
    except GENICAM_ERRORS as error:
        # Tried all the same: what a producer says of addresses is not always right.
        if found.seen.state is CameraState.OUT_OF_REACH:
            text = f"{label} {_where(found.seen)}: {in_words(error)}"
            raise TroubleError(Trouble.SUBNET, text) from error
        trouble = Trouble.BUSY if isinstance(error, TAKEN) else Trouble.LOST
        raise TroubleError(trouble, f"{label}: {in_words(error)}") from error


def label_of(keys: Mapping[str, str]) -> str:
    """The key that names a camera, with its value."""
    return " ".join(f"{key} {text}" for key, text in keys.items())


def _in_words(one: SeenCamera) -> str:
    name = one.serial_number or one.id
    return f"{name} ({one.model}{f' at {one.ip_address}' if one.ip_address else ''})"


def _where(one: SeenCamera) -> str:
    if not one.ip_address or not one.subnets:
        return "cannot be reached from this PC, says its producer"
    return f"has the address {one.ip_address}, this PC has {', '.join(one.subnets)} on that line"
