"""Translates errors of sockets, serial lines and CAN, and the answers of the box, to faults."""

from cellctl.errors.force import SensorSetupWrong
from cellctl.errors.link import ConnectTimeout, LinkLost, ReplyTimeout, StaleData


def cannot_connect(peer: str, reason: object) -> ConnectTimeout:
    """Fault of a link that did not come up."""
    return ConnectTimeout(f"force sensor at {peer}: {reason}")


def lost(peer: str, reason: object) -> LinkLost:
    """Fault of a link that broke."""
    return LinkLost(f"force sensor at {peer}: {reason}")


def no_reply(peer: str, request: str) -> ReplyTimeout:
    """Fault of a command that was not answered."""
    return ReplyTimeout(f"force sensor at {peer}: no reply to {request}")


def late(peer: str, lag_s: float, allowed_s: float) -> StaleData:
    """Fault of samples that are old when they arrive, although they arrive at the right rate."""
    return StaleData(
        f"force sensor at {peer}: samples arrive {lag_s:.2f} s late, allowed {allowed_s:g} s"
    )


def wrong_setup(what: str, found: object, expected: object) -> SensorSetupWrong:
    """Fault of a setting that is not what the cell file says."""
    return SensorSetupWrong(f"{what} is {found}, expected {expected}")


def not_counting(peer: str, number: int) -> SensorSetupWrong:
    """Fault of a box whose frames all have one number: each but the first would pass for an old
    one that was sent again, and the sensor for silent."""
    return SensorSetupWrong(
        f"package number of the force sensor at {peer} is {number} in every frame, expected one "
        "more in each: frames that come anew cannot be told from repeated ones; see the box's "
        "settings and firmware"
    )
