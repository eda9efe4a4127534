"""Input files of the offline calibrations: JSON in mm and degrees (docs/calibration.md).

Each solver describes its file as a model beside it. Here is what the models share: the reading,
poses and positions as users write them, and words for whatever is wrong, with its place.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, PlainValidator, ValidationError
from pydantic_core import ErrorDetails
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.pose_record import covariance_from_written, matrix_mm_to_pose
from cellctl.calibration.unit_slips import require_usual_units
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, Array

_SHOWN_ERRORS = 5


class InputFile(BaseModel):
    """A file, or an object in it. Unknown keys are ignored: results serve as input, too."""

    model_config = ConfigDict(
        frozen=True,
        arbitrary_types_allowed=True,
        coerce_numbers_to_str=True,
        allow_inf_nan=False,
        extra="ignore",
    )
    seen_from_afar: ClassVar[bool] = False
    """Whether all that it holds is far from the frame in which it is written, so that metres and
    radians can be told from millimetres and degrees (``unit_slips``)."""


M = TypeVar("M", bound=InputFile)


def read_input(path: Path, model: type[M]) -> M:
    """Read a file; raises ``FileInvalid`` with everything that is wrong, each with its place."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise FileInvalid(f"{path}: {error.strerror or error}") from error
    try:
        found = model.model_validate_json(content)
    except ValidationError as error:
        raise FileInvalid(f"{path}: {error_words(error)}") from error
    if model.seen_from_afar:
        require_usual_units(str(path), json.loads(content))
    return found


def error_words(error: ValidationError) -> str:
    """Everything that is wrong with a file, each with its place, on one line."""
    details = error.errors()
    shown = [_words(detail) for detail in details[:_SHOWN_ERRORS]]
    if len(details) > _SHOWN_ERRORS:
        shown.append(f"and {len(details) - _SHOWN_ERRORS} more")
    return "; ".join(shown)


def _words(detail: ErrorDetails) -> str:
    """One error, for example ``poses, entry 1: missing 'base_T_flange'``."""
    kind, place = detail["type"], detail["loc"]
    if kind == "json_invalid":
        return f"is not JSON: {detail['ctx']['error']}"
    if not place and kind == "model_type":
        return "the file must hold one object"
    if kind == "missing":
        return f"{_place(place[:-1])}missing {place[-1]!r}"
    if kind == "extra_forbidden":
        return f"{_place(place[:-1])}unknown key {place[-1]!r}"
    if kind == "value_error":
        message = str(detail["ctx"]["error"])
    else:
        # What was found belongs to the message: a comma or a unit in the wrong place is seen at
        # once.
        message = f"{detail['msg']}, got {_shorten(repr(detail['input']))}"
    key = f" (key {place[-1]!r})" if place and isinstance(place[-1], str) else ""
    return f"{_place(place[:-1] if key else place)}{message}{key}"


def _place(keys: Sequence[int | str]) -> str:
    """``a, entry 2: b, entry 1: `` for the key b in the second entry of the list a."""
    words = ""
    for key in keys:
        words += f", entry {key + 1}" if isinstance(key, int) else f": {key}"
    return f"{words.removeprefix(': ')}: " if words else ""


def _shorten(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."


def numbers(values: Any, shape: tuple[int | None, ...], what: str) -> Array:
    """Finite numbers as an array of this shape; None stands for any length.

    Raises ``ValueError``: ``what`` they must be.
    """
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(what) from error
    # The shape is tested here and not left to the solver, whose error would name no key of the
    # file.
    fits = array.ndim == len(shape) and all(
        wanted in (None, length) for wanted, length in zip(shape, array.shape, strict=True)
    )
    if not fits or not np.isfinite(array).all():
        raise ValueError(what)
    return array


def _position_m(values: Any) -> Array:
    return numbers(values, (3,), "position_mm must be three numbers") * MM


def _points_m(values: Any) -> Array:
    return numbers(values, (None, 3), "must be a list of points [x, y, z]") * MM


def _pose_covariance(values: Any) -> Array:
    return covariance_from_written(numbers(values, (6, 6), "covariance_mm_deg must be 6 x 6"))


InputPose = Annotated[RigidTransform, PlainValidator(matrix_mm_to_pose)]
"""A 4 x 4 matrix in mm, or X, Y, Z, A, B, C in mm and degrees."""
InputPosition = Annotated[Array, PlainValidator(_position_m)]
"""Written in mm; shape (3,), m."""
InputPoints = Annotated[Array, PlainValidator(_points_m)]
"""Written in mm; shape (n, 3), m."""
InputPoseCovariance = Annotated[Array, PlainValidator(_pose_covariance)]
"""Written in mm and degrees; shape (6, 6), m and rad."""
