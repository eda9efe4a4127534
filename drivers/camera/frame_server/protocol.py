"""CFS/1 requests and replies: bytes to values and back, without I/O
(docs/protocols/frame-server.md).
"""

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from cellctl.errors.link import ProtocolViolation
from cellctl.interfaces.stereo_camera import Image

VERSION = 1
MONO8 = 1
IMAGES_PER_GRAB = 2
MAX_PAYLOAD_BYTES = 200_000_000
"""More than any head has; a header that asks for more is wrong."""
IDENTITY_BYTES = 4096

_REQUEST = struct.Struct(">4sHHII")
_HEADER = struct.Struct(">4sHHIIQIHHHHIII")
HEADER_BYTES = _HEADER.size


class Command(IntEnum):
    """What the client asks for."""

    IDENTIFY = 1
    GRAB = 2


class Status(IntEnum):
    """How the server answers."""

    OK = 0
    BUSY = 1
    CAMERA_FAULT = 2
    BAD_REQUEST = 3


@dataclass(frozen=True, slots=True)
class Header:
    """The fixed part of a reply."""

    status: Status
    request_id: int
    frame_id: int
    exposure_time_us: int
    """Start of the exposure, by the server's clock."""
    exposure_us: int
    width: int
    height: int
    images: int
    payload_bytes: int
    payload_crc: int


def request(command: Command, request_id: int) -> bytes:
    """One request, 16 bytes."""
    return _REQUEST.pack(b"CFSQ", VERSION, command, request_id, 0)


def parse_header(data: bytes, command: Command, request_id: int) -> Header:
    """The header of the reply to a request; ``ProtocolViolation`` when any field does not fit."""
    if len(data) != HEADER_BYTES:
        raise ProtocolViolation(f"header of {len(data)} bytes")
    magic, version, status, echoed, frame_id, time_us, exposure_us, *rest = _HEADER.unpack(data)
    width, height, images, pixel_format, length, crc, own_crc = rest
    if own_crc != zlib.crc32(data[:-4]):
        raise ProtocolViolation("header CRC does not match")
    if magic != b"CFSR" or version != VERSION:
        raise ProtocolViolation(f"magic {magic!r}, version {version}")
    if status not in {known.value for known in Status}:
        raise ProtocolViolation(f"unknown status {status}")
    header = Header(
        *(Status(status), echoed, frame_id, time_us, exposure_us),
        *(width, height, images, length, crc),
    )
    if echoed != request_id:
        raise ProtocolViolation(f"reply to request {echoed} instead of {request_id}")
    _check_size(header, command, pixel_format)
    return header


def _check_size(header: Header, command: Command, pixel_format: int) -> None:
    size = (header.images, header.payload_bytes)
    if header.status is not Status.OK:
        fits = header.payload_bytes == 0
    elif command is Command.GRAB:
        pixels = header.width * header.height
        fits = size == (IMAGES_PER_GRAB, IMAGES_PER_GRAB * pixels) and pixels > 0
        fits = fits and pixel_format == MONO8 and header.payload_bytes <= MAX_PAYLOAD_BYTES
    else:
        fits = header.images == 0 and header.payload_bytes <= IDENTITY_BYTES
    if not fits:
        raise ProtocolViolation(
            f"{size[0]} images of {header.width} x {header.height}, format {pixel_format}, "
            f"in {size[1]} bytes"
        )


def check_payload(header: Header, payload: bytes) -> None:
    """``ProtocolViolation`` when the payload is not the one that was announced."""
    if len(payload) != header.payload_bytes or zlib.crc32(payload) != header.payload_crc:
        raise ProtocolViolation("payload CRC does not match")


def split_images(header: Header, payload: bytes) -> tuple[Image, Image]:
    """Left and right image, shape (height, width), read-only views of the payload."""
    pair = np.frombuffer(payload, np.uint8).reshape(2, header.height, header.width)
    return pair[0], pair[1]


def parse_identity(payload: bytes) -> tuple[str, str, str]:
    """Model, serial number and firmware."""
    try:
        model, serial, firmware = payload.decode("utf-8").split(";")
    except ValueError as error:
        raise ProtocolViolation(f"identity {payload[:80]!r}") from error
    return model, serial, firmware
