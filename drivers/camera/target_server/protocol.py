"""TGT/1 requests and replies: lines to values and back, without I/O
(docs/protocols/target-server.md). Millimetres of the wire become metres here.
"""

import json
from typing import Any

import numpy as np

from cellctl.errors.link import ProtocolViolation
from cellctl.geometry.pose import MM
from cellctl.interfaces.target_tracker import Target
from drivers.camera.target_server import faults

MAX_LINE_BYTES = 65536
MAX_FRAMES = 200
MAX_MM = 1e6


def identify(request_id: int) -> bytes:
    """Request of model and serial number."""
    return _line({"id": request_id, "cmd": "identify"})


def measure(request_id: int, frames: int) -> bytes:
    """Request of a measurement over 1 to 200 frames."""
    return _line({"id": request_id, "cmd": "measure", "frames": frames})


def parse_identity(line: bytes, request_id: int) -> tuple[str, str, str]:
    """Model, serial number and firmware."""
    reply = _reply(line, request_id)
    model, serial, firmware = (reply.get(key) for key in ("model", "serial", "firmware"))
    if not (isinstance(model, str) and isinstance(serial, str) and isinstance(firmware, str)):
        raise ProtocolViolation(f"incomplete identity: {line[:160]!r}")
    return model, serial, firmware


def parse_targets(line: bytes, request_id: int) -> tuple[Target, ...]:
    """The measured targets, in metres."""
    entries = _reply(line, request_id).get("targets")
    if not isinstance(entries, list):
        raise ProtocolViolation(f"no list of targets: {line[:160]!r}")
    targets = tuple(_target(entry) for entry in entries)
    # Which of the two is meant cannot be told, and a solver would silently use the last.
    if len({target.name for target in targets}) != len(targets):
        raise ProtocolViolation(f"a target is there twice: {[t.name for t in targets]}")
    return targets


def _line(request: dict[str, Any]) -> bytes:
    return json.dumps(request).encode("utf-8") + b"\n"


def _reply(line: bytes, request_id: int) -> dict[str, Any]:
    """The reply as an object; ``DeviceFault`` when the server reports an error."""
    try:
        reply = json.loads(line)
    # A few kilobytes of brackets exceed the depth of the parser.
    except (ValueError, RecursionError) as error:
        raise ProtocolViolation(f"not JSON: {line[:160]!r}") from error
    if not isinstance(reply, dict):
        raise ProtocolViolation(f"not an object: {line[:160]!r}")
    # ``True == 1`` in Python: the type has to be looked at as well.
    if type(reply.get("id")) is not int or reply["id"] != request_id:
        raise ProtocolViolation(f"reply to request {reply.get('id')!r} instead of {request_id}")
    if reply.get("status") == "error":
        # A refusal is a whole and proper answer, so the connection stays.
        raise faults.reported(reply.get("message", "no message"))
    if reply.get("status") != "ok":
        raise ProtocolViolation(f"unknown status {str(reply.get('status'))[:40]!r}")
    return reply


def _target(entry: object) -> Target:
    if not isinstance(entry, dict):
        raise ProtocolViolation(f"bad target {str(entry)[:160]}")
    name, xyz_mm, sigma_mm = entry.get("name"), entry.get("xyz_mm"), entry.get("sigma_mm")
    if not (isinstance(name, str) and isinstance(xyz_mm, list) and len(xyz_mm) == 3):
        raise ProtocolViolation(f"bad target {str(entry)[:160]}")
    x_m, y_m, z_m = (_metres(value) for value in xyz_mm)
    sigma_m = _metres(sigma_mm)
    if sigma_m <= 0.0:
        raise ProtocolViolation(f"bad sigma {str(entry)[:160]}")
    return Target(name, np.array([x_m, y_m, z_m]), sigma_m)


def _metres(value: object) -> float:
    """A finite number of a size that a position can have; ``bool`` is none."""
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < MAX_MM:
        return float(value) * MM
    raise ProtocolViolation(f"bad number {str(value)[:40]!r}")
