"""CFS/1 requests and replies: bytes to values and back, without I/O
(docs/protocols/frame-server.md).
"""

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from cellctl.errors.link import ProtocolViolation
from cellctl.interfaces.camera import PixelFormat
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image

VERSION = 1
MAX_PAYLOAD_BYTES = 200_000_000
"""More than any camera has; a header that asks for more is wrong."""
IDENTITY_BYTES = 4096

_REQUEST = struct.Struct(">4sHHII")
_HEADER = struct.Struct(">4sHHIIQIHHHHIII")
HEADER_BYTES = _HEADER.size


class ServerCommand(IntEnum):
    """What the client asks for."""

    IDENTIFY = 1
    GRAB_PAIR = 2
    GRAB_IMAGE = 3


class ServerStatus(IntEnum):
    """How the server answers."""

    OK = 0
    BUSY = 1
    CAMERA_FAULT = 2
    BAD_REQUEST = 3


@dataclass(frozen=True, slots=True)
class _Layout:
    """How the samples of a pixel format lie in the payload."""

    pixel_format: PixelFormat
    sample: str
    """Type of one sample, as numpy writes it."""
    channels: int

    @property
    def pixel_bytes(self) -> int:
        return np.dtype(self.sample).itemsize * self.channels


_LAYOUTS = {
    1: _Layout(PixelFormat.MONO8, ">u1", 1),
    2: _Layout(PixelFormat.MONO16, ">u2", 1),
    3: _Layout(PixelFormat.RGB8, ">u1", 3),
}
"""Pixel formats by their number on the wire."""
_IMAGES = {ServerCommand.IDENTIFY: 0, ServerCommand.GRAB_PAIR: 2, ServerCommand.GRAB_IMAGE: 1}
_FORMATS = {
    # A stereo head measures holes in 8 bit grey; the interface of the head says so.
    ServerCommand.GRAB_PAIR: (PixelFormat.MONO8,),
    ServerCommand.GRAB_IMAGE: tuple(PixelFormat),
}


@dataclass(frozen=True, slots=True)
class Header:
    """The fixed part of a reply."""

    status: ServerStatus
    request_id: int
    frame_id: int
    exposure_time_us: int
    """Start of the exposure, by the server's clock."""
    exposure_us: int
    width: int
    height: int
    images: int
    format_code: int
    payload_bytes: int
    payload_crc: int


def request(command: ServerCommand, request_id: int) -> bytes:
    """One request, 16 bytes."""
    return _REQUEST.pack(b"CFSQ", VERSION, command, request_id, 0)


def parse_header(data: bytes, command: ServerCommand, request_id: int) -> Header:
    """The header of the reply to a request; ``ProtocolViolation`` when any field does not fit."""
    if len(data) != HEADER_BYTES:
        raise ProtocolViolation(f"header of {len(data)} bytes")
    magic, version, status, *fields, own_crc = _HEADER.unpack(data)
    # The header has a check of its own, because it says how many bytes follow: a wrong length would
    # have to be waited for until the time-out.
    if own_crc != zlib.crc32(data[:-4]):
        raise ProtocolViolation("header CRC does not match")
    if magic != b"CFSR" or version != VERSION:
        raise ProtocolViolation(f"magic {magic!r}, version {version}")
    if status not in {known.value for known in ServerStatus}:
        raise ProtocolViolation(f"unknown status {status}")
    header = Header(ServerStatus(status), *fields)
    # The late reply to an earlier request would be an image from before the arm moved.
    if header.request_id != request_id:
        raise ProtocolViolation(f"reply to request {header.request_id} instead of {request_id}")
    if not _size_fits(header, command):
        raise ProtocolViolation(
            f"{header.images} images of {header.width} x {header.height}, "
            f"format {header.format_code}, in {header.payload_bytes} bytes"
        )
    return header


def _size_fits(header: Header, command: ServerCommand) -> bool:
    """Whether the announced images are what the command asks for and fill the payload exactly."""
    if header.status is not ServerStatus.OK:
        return header.payload_bytes == 0
    if header.images != _IMAGES[command]:
        return False
    if command is ServerCommand.IDENTIFY:
        return header.payload_bytes <= IDENTITY_BYTES
    layout = _LAYOUTS.get(header.format_code)
    if layout is None or layout.pixel_format not in _FORMATS[command]:
        return False
    expected = header.images * header.width * header.height * layout.pixel_bytes
    # Exactly what the sizes say: an image that is a row short would be read without complaint.
    return 0 < header.payload_bytes == expected <= MAX_PAYLOAD_BYTES


def check_payload(header: Header, payload: bytes) -> None:
    """``ProtocolViolation`` when the payload is not the one that was announced."""
    if len(payload) != header.payload_bytes or zlib.crc32(payload) != header.payload_crc:
        raise ProtocolViolation("payload CRC does not match")


def split_images(header: Header, payload: bytes) -> tuple[Image, Image]:
    """Left and right image, shape (height, width), read-only views of the payload."""
    pair = np.frombuffer(payload, np.uint8).reshape(2, header.height, header.width)
    return pair[0], pair[1]


def to_pixels(
    header: Header, payload: bytes
) -> tuple[NDArray[np.uint8] | NDArray[np.uint16], PixelFormat]:
    """The image of a single camera, shaped as its format says; 8 bit images are read-only views."""
    layout = _LAYOUTS[header.format_code]
    samples = np.frombuffer(payload, layout.sample)
    shape: tuple[int, ...] = (header.height, header.width)
    if layout.channels > 1:
        shape = (*shape, layout.channels)
    # Samples of two bytes come in network order; the rest of the program counts on the PC's own.
    native = samples.astype(samples.dtype.newbyteorder("="), copy=False)
    return native.reshape(shape), layout.pixel_format


def exposure_record(header: Header) -> ExposureRecord:
    """What a reply says of the exposure of each of its images."""
    layout = _LAYOUTS[header.format_code]
    return ExposureRecord(
        serial_number=None,
        pixel_format=layout.pixel_format.value,
        bits=8 * np.dtype(layout.sample).itemsize,
        exposure_s=header.exposure_us * 1e-6,
        device_time_ns=header.exposure_time_us * 1000,
    )


def parse_identity(payload: bytes) -> tuple[str, str, str]:
    """Model, serial number and firmware."""
    try:
        model, serial, firmware = payload.decode("utf-8").split(";")
    except ValueError as error:
        raise ProtocolViolation(f"identity {payload[:80]!r}") from error
    return model, serial, firmware
