"""Images as they were recorded, with the rims that were measured in them."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from enum import StrEnum
from functools import partial

import numpy as np
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from foxglove_schemas_protobuf.Point2_pb2 import Point2
from foxglove_schemas_protobuf.PointsAnnotation_pb2 import PointsAnnotation
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from foxglove_schemas_protobuf.TextAnnotation_pb2 import TextAnnotation

from cellctl.errors.records.store import ArtefactDamaged
from cellctl.records.entries import Artefact, RunRecord
from cellctl.records.files.raw_images import MEDIA_TYPE, decode
from cellctl.records.looks import MeasuredRim, TakenImage, rims_of, taken_images
from cellctl.records.run_mcap.message import (
    Content,
    JsonValues,
    TimedMessage,
    nanoseconds,
    stamp,
)
from cellctl.records.run_mcap.sources import RunSources
from cellctl.vision.camera.ellipse import Ellipse

JPEG_QUALITY = 80
"""For looking at; measurements are made from the raw images, which the run keeps."""
OUTLINE_POINTS = 36
"""Corners of the line that is drawn for an ellipse: one every 10°, which looks round."""
_NAME = re.compile(r"raw/(?P<look>.+?)-frame-\d+(?:-(?P<view>.+))?\.pgm\.zst")
_PICTURES = {"image/jpeg": "jpeg", "image/png": "png"}
_USED = Color(r=0.2, g=0.9, b=0.2, a=1.0)
_NOT_USED = Color(r=1.0, g=0.3, b=0.2, a=1.0)
_PIXEL_CENTRE = 0.5
"""Viewers count from the corner of the first pixel, measurements from its centre."""


class ImageForm(StrEnum):
    """What becomes of the raw images."""

    LOSSLESS = "lossless"
    """Every pixel as the camera gave it; some 3 MB an image."""
    JPEG = "jpeg"
    """Smaller images to look at and to send; some 0.3 MB an image."""
    NONE = "none"


def images(sources: RunSources, form: ImageForm) -> Iterator[TimedMessage]:
    """Raw images, rims, and the pictures of what has no rims."""
    record = sources.record
    raw = {one.name: one for one in record.artefacts if one.media_type == MEDIA_TYPE}
    taken, rims = taken_images(record), rims_of(record)
    undated = [name for name in raw if name not in taken]
    if undated:
        sources.missing.append(f"times of {len(undated)} images: each has that of its storing")
    last: dict[tuple[str, str], int] = {}
    for name, artefact in raw.items():
        image = taken.get(name) or _by_name(artefact)
        time_ns, topic = nanoseconds(image.time), f"/images/{image.view}"
        if form is not ImageForm.NONE:
            yield TimedMessage(time_ns, topic, partial(_image, sources, artefact, image, form))
        seen = rims.get((image.look, image.view))
        if seen:
            last[image.look, image.view] = max(last.get((image.look, image.view), 0), time_ns)
            yield TimedMessage(time_ns, f"{topic}/annotations", _annotations(time_ns, seen))
    for (look, view), time_ns in last.items():
        values = {"look": look, "view": view, "rims": [asdict(rim) for rim in rims[look, view]]}
        yield TimedMessage(time_ns, f"/images/{view}/rims", JsonValues("cellctl.Rims", values))
    lost = sorted(set(taken) - set(raw))
    sources.missing += [f"{name}: taken, and not kept" for name in lost]
    if form is not ImageForm.NONE:
        yield from _pictures(sources, rims)


def _by_name(artefact: Artefact) -> TakenImage:
    found = _NAME.fullmatch(artefact.name)
    look = found["look"] if found else artefact.name
    return TakenImage(look, (found and found["view"]) or look, artefact.time)


def _image(
    sources: RunSources, artefact: Artefact, image: TakenImage, form: ImageForm
) -> Content | None:
    data = sources.read(artefact)
    try:
        pixels = None if data is None else decode(data)
    except ArtefactDamaged as fault:
        sources.missing.append(f"{artefact.name}: {fault}")
        return None
    if pixels is None:
        return None
    time, (height, width) = stamp(nanoseconds(image.time)), pixels.shape
    if form is ImageForm.LOSSLESS:
        return RawImage(
            timestamp=time, frame_id=image.view, width=width, height=height,
            encoding="mono8", step=width, data=pixels.tobytes(),
        )  # fmt: skip
    import cv2

    _, coded = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return CompressedImage(timestamp=time, frame_id=image.view, format="jpeg", data=coded.tobytes())


def _annotations(time_ns: int, rims: tuple[MeasuredRim, ...]) -> ImageAnnotations:
    return ImageAnnotations(
        timestamp=stamp(time_ns),
        points=[_outline(rim) for rim in rims],
        texts=[_label(rim) for rim in rims],
    )


def _outline(rim: MeasuredRim) -> PointsAnnotation:
    ellipse = Ellipse(np.array(rim.ellipse_centre_px), rim.semi_axes_px, rim.angle_rad)
    return PointsAnnotation(
        type=PointsAnnotation.LINE_LOOP,
        points=[_point(x, y) for x, y in ellipse.points(OUTLINE_POINTS).tolist()],
        outline_color=_USED if rim.used else _NOT_USED,
        thickness=1.0,
    )


def _label(rim: MeasuredRim) -> TextAnnotation:
    far = "" if rim.residual_um is None else f" {rim.residual_um:.1f} µm"
    x, y = rim.ellipse_centre_px
    return TextAnnotation(
        position=_point(x + rim.semi_axes_px[0], y - rim.semi_axes_px[0]),
        text=f"{rim.name}{far}{'' if rim.used else ', not used'}",
        font_size=24.0,
        text_color=_USED if rim.used else _NOT_USED,
        background_color=Color(a=0.5),
    )


def _point(column_px: float, row_px: float) -> Point2:
    return Point2(x=column_px + _PIXEL_CENTRE, y=row_px + _PIXEL_CENTRE)


def _pictures(
    sources: RunSources, rims: Mapping[tuple[str, str], tuple[MeasuredRim, ...]]
) -> Iterator[TimedMessage]:
    """Drawn pictures, of which a viewer cannot draw the like from the rims."""
    drawn = {f"{look}-{view}" for look, view in rims}
    for artefact in sources.record.artefacts:
        stem = artefact.name.rsplit(".", 1)[0]
        if artefact.media_type in _PICTURES and stem not in drawn:
            topic = f"/pictures/{_view(sources.record, stem)}"
            content = partial(_picture, sources, artefact, stem)
            yield TimedMessage(nanoseconds(artefact.time), topic, content)


def _view(record: RunRecord, stem: str) -> str:
    """The camera that a picture comes from, where one of the looks says so, else its own name."""
    views = {
        found["view"]
        for one in record.artefacts
        if (found := _NAME.fullmatch(one.name)) and found["view"]
    }
    return next((view for view in sorted(views) if stem.endswith(f"-{view}")), stem)


def _picture(sources: RunSources, artefact: Artefact, stem: str) -> Content | None:
    data = sources.read(artefact)
    if data is None:
        return None
    return CompressedImage(
        timestamp=stamp(nanoseconds(artefact.time)),
        frame_id=stem,
        format=_PICTURES[artefact.media_type],
        data=data,
    )
