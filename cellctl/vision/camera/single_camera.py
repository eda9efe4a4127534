"""The calibration of a single camera and its JSON file, with an identity.

What was calibrated with a camera (its pose, a plane before it) holds with the same intrinsics only:
an error of the principal point is absorbed by the pose, and comes back in full when one of the two
is exchanged. The identity is therefore made from the intrinsics themselves.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cellctl.errors.vision import CameraFileInvalid
from cellctl.sealed_json import record_within
from cellctl.vision.camera.stereo_head import CameraModel, camera_from_json, camera_to_json


@dataclass(frozen=True, slots=True, eq=False)
class SingleCamera:
    """One calibrated camera."""

    image_size: tuple[int, int]
    """Width, height in px."""
    model: CameraModel

    @property
    def id(self) -> str:
        """SHA-256 of image size, camera matrix and distortion, 64 hexadecimal digits."""
        content = json.dumps(_content(self), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(content.encode()).hexdigest()


def read_single_camera(path: Path) -> SingleCamera:
    """Read a calibration, of a command or stored; ``CameraFileInvalid`` says why not."""
    try:
        data = json.loads(path.read_bytes())
    except OSError as error:
        raise CameraFileInvalid(f"{path}: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise CameraFileInvalid(f"{path} is not JSON: {error}") from error
    try:
        return single_camera_from_json(record_within(data))
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        reason = f"missing {error}" if isinstance(error, KeyError) else str(error)
        raise CameraFileInvalid(f"{path}: {reason}") from error


def single_camera_to_json(camera: SingleCamera) -> dict[str, Any]:
    """The camera as the plain data of its file."""
    return {"id": camera.id, **_content(camera)}


def single_camera_from_json(data: Mapping[str, Any]) -> SingleCamera:
    """The inverse; raises ``KeyError``, ``TypeError``, ``ValueError`` or ``OverflowError``."""
    if not isinstance(data, dict):
        raise TypeError("the file must hold one object")
    width, height = data["image_size"]
    for side in (width, height):
        # A bool is an int in Python.
        if isinstance(side, bool) or not isinstance(side, int) or not 0 < side <= 100_000:
            raise ValueError("image_size must be two positive whole numbers")
    camera = SingleCamera((width, height), camera_from_json(data))
    if data["id"] != camera.id:
        raise ValueError("id does not belong to these intrinsics: the file was changed")
    return camera


def _content(camera: SingleCamera) -> dict[str, Any]:
    return {"image_size": list(camera.image_size), **camera_to_json(camera.model)}
