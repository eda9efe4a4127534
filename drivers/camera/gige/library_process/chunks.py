"""What a camera says of an image behind it: chunk data, where its features switch it on."""

from dataclasses import dataclass
from typing import Any

from genicam import genapi

from drivers.camera.gige.library_process.delivered import said
from drivers.camera.gige.library_process.trouble import GENICAM_ERRORS

_LAYOUTS = {"GEV": genapi.ChunkAdapterGEV, "U3V": genapi.ChunkAdapterU3V}
"""Transports whose chunks are found in the buffer itself; of others the producer lists them."""


@dataclass(frozen=True, slots=True)
class ImageChunks:
    """What the chunks of one image say; None where they do not say it."""

    exposure_s: float | None = None
    gain_db: float | None = None


def image_chunks(buffer: Any, nodes: Any) -> ImageChunks:
    """The chunks of a buffer; ``buffer`` is the module of genicam, ``nodes`` those of the camera.

    A buffer whose chunks cannot be read says nothing; its image is none the worse for it.
    """
    if not _has_chunks(buffer):
        return ImageChunks()
    layout = _LAYOUTS.get(said(lambda: str(buffer.tl_type), ""))
    adapter = (layout or genapi.ChunkAdapterGeneric)(nodes)
    try:
        if layout is None:
            adapter.attach_buffer(buffer.raw_buffer, buffer.chunk_data_info_list)
        else:
            adapter.attach_buffer(buffer.raw_buffer, _size(buffer))
        exposure_us = _number(nodes, "ChunkExposureTime")
        exposure_s = None if exposure_us is None else exposure_us * 1e-6
        return ImageChunks(exposure_s, _number(nodes, "ChunkGain"))
    except GENICAM_ERRORS:
        return ImageChunks()
    finally:
        # The buffer goes back to the producer, so no feature may point into it.
        adapter.detach_buffer()


def _has_chunks(buffer: Any) -> bool:
    count = said(lambda: int(buffer.num_chunks), 0)
    return said(lambda: bool(buffer.is_containing_chunk_data()), count > 0)


def _size(buffer: Any) -> int:
    """Bytes up to the end of the last chunk."""
    stated = said(lambda: int(buffer.delivered_chunk_payload_size), 0)
    return stated or said(lambda: int(buffer.size_filled), 0) or len(buffer.raw_buffer)


def _number(nodes: Any, name: str) -> float | None:
    return said(lambda: float(getattr(nodes, name).value), None)
