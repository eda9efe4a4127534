"""The messages between daemon and guard: each is one JSON object in one packet of a socket pair.

Requests have an ``id`` and a ``do``; answers repeat the id with ``result`` or ``refused``; events
have an ``event``. The socket keeps the packets apart, so there is no framing to get out of step.
The guard never waits for room: an event that does not fit is dropped, and the shared status tells
the same facts.

The guard process imports this module, so it imports no arrays; they are named in annotations only.
"""

from __future__ import annotations

import json
import socket
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from cellctl.errors.base import CellError
from cellctl.errors.internal import Unexpected
from cellctl.fault_catalogue import known_fault
from cellctl.guard.limits import CusumTouch, GuardLimits, GuardSettings
from cellctl.guard.report import GuardTrip, TripReason

if TYPE_CHECKING:
    from scipy.spatial.transform import RigidTransform

    from cellctl.force.gravity.gravity_compensation import GravityCompensation

Message = dict[str, Any]

_LONGEST_BYTES = 65_536
"""Far above the longest message. A packet that is longer would be cut off."""


OPEN: Message = {"do": "open"}
"""Has a guard that was set up open sensor and stop channel, and guard."""


def encode(message: Message) -> bytes:
    """The bytes of a message, for one packet."""
    # A limit that is not watched is infinite, which Python writes as ``Infinity``. That is no JSON,
    # but both ends of this socket are Python.
    return json.dumps(message, separators=(",", ":")).encode()


def receive(link: socket.socket) -> Message | None:
    """The next packet; None at the end. ``BlockingIOError`` when none waits."""
    data = link.recv(_LONGEST_BYTES)
    if not data:
        return None
    message: Message = json.loads(data)
    return message


def set_up_to_json(
    sensor: Message, stop_channel: Message | None, settings: GuardSettings
) -> Message:
    """The first message to a guard, from which it loads its drivers; ``OPEN`` is the second.

    ``sensor`` and ``stop_channel`` hold the ``name`` of a plug-in and its ``config``. What only the
    daemon needs of the settings stays here.
    """
    return {
        "sensor": sensor,
        "stop_channel": stop_channel,
        "flange_R_sensor": settings.flange_T_sensor.rotation.as_matrix().ravel().tolist(),
        "beat_s": settings.beat_s,
        "stop_confirm_s": settings.stop_confirm_s,
        "fifo_priority": settings.fifo_priority,
        "cpu": settings.cpu,
        "lock_memory": settings.lock_memory,
    }


def limits_to_json(limits: GuardLimits) -> Message:
    """Limits in the form of a message."""
    return asdict(limits)


def limits_from_json(message: Message) -> GuardLimits:
    """The limits that a message holds; ``ValueError`` or ``TypeError`` when it holds none."""
    fields = dict(message)
    # JSON knows neither dataclasses nor tuples, and limits are frozen values made of both.
    if fields.get("touch") is not None:
        fields["touch"] = CusumTouch(**fields["touch"])
    for name in ("raw", "filtered", "rate_hz"):
        fields[name] = tuple(fields[name])
    if fields.get("braking") is not None:
        fields["braking"] = tuple(fields["braking"])
    return GuardLimits(**fields)


def gravity_compensation_to_json(compensation: GravityCompensation) -> Message:
    """What hangs on the sensor in the form of a message."""
    return {
        "load": compensation.A.tolist(),
        "offset": compensation.b.tolist(),
        "base_down": list(compensation.base_down),
    }


def wrench_frame_to_json(sensor_T_wrench: RigidTransform) -> Message:
    """The frame of the wrenches in the form of a message, the rotation row by row."""
    return {
        "rotation": sensor_T_wrench.rotation.as_matrix().ravel().tolist(),
        "translation_m": sensor_T_wrench.translation.tolist(),
    }


def trip_to_json(trip: GuardTrip) -> Message:
    """A trip in the form of a message."""
    return {**asdict(trip), "reason": trip.reason.value}


def trip_from_json(message: Message) -> GuardTrip:
    """The trip that a message holds."""
    return GuardTrip(**{**message, "reason": TripReason(message["reason"])})


def fault_to_json(fault: CellError) -> Message:
    """A fault in the form of a message: its number and its facts."""
    return {"number": fault.number, "detail": fault.detail}


def fault_from_json(message: Message) -> CellError:
    """The fault with that number; ``Unexpected`` for a number that nobody has."""
    number, detail = message["number"], message["detail"]
    kind = known_fault(number)
    # The driver of a plug-in may keep its faults where only the guard's process has loaded them.
    if kind is None:
        return Unexpected(f"the guard reports fault {number}: {detail}")
    return kind(detail)
