"""The input file of a board transfer."""

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import Field, PlainValidator, model_validator

from cellctl.calibration.boards.board_pose import BoardPoint, fit_board, target_board_discs
from cellctl.calibration.input_file import (
    InputFile,
    InputPose,
    InputPoseCovariance,
    InputPosition,
    numbers,
)
from cellctl.calibration.solvers.transfer.board_transfer import BoardPlacement
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.sealed_json import record_within


def _covariance_m2(values: Any) -> Array:
    return numbers(values, (3, 3), "covariance_mm2 must be 3 x 3") * MM**2


class DiscEntry(InputFile):
    """A disc of the target board as a head sees it, with sigma or covariance."""

    name: str
    position_mm: InputPosition
    covariance_mm2: Annotated[Array, PlainValidator(_covariance_m2)] | None = None
    """Kept in m²."""
    sigma_mm: Annotated[float, Field(gt=0, le=10)] | None = None

    @model_validator(mode="after")
    def _has_its_uncertainty(self) -> "DiscEntry":
        if self.covariance_mm2 is None and self.sigma_mm is None:
            raise ValueError("missing 'sigma_mm'")
        return self

    def point(self) -> BoardPoint:
        """The disc as the registration takes it."""
        covariance = self.covariance_mm2
        if covariance is None:
            covariance = np.eye(3) * ((self.sigma_mm or 0.0) * MM) ** 2
        return BoardPoint(self.name, self.position_mm, covariance)


class PlacementEntry(InputFile):
    """One place of the board before a head."""

    large_field: tuple[DiscEntry, ...]
    head: tuple[DiscEntry, ...]


class TransferFile(InputFile):
    """The whole file."""

    seen_from_afar = True

    c_T_base: InputPose
    """Or the object of that name in the result of a base-frame calibration, or a stored one."""
    c_T_base_covariance_mm_deg: InputPoseCovariance | None = None
    drawing_mm: Mapping[str, InputPosition] | None = None
    """Discs of the board; without it those of the board in the documentation."""
    head_1: tuple[PlacementEntry, ...]
    head_2: tuple[PlacementEntry, ...]

    @model_validator(mode="before")
    @classmethod
    def _take_result_of_base_frame(cls, data: Any) -> Any:
        base = record_within(data.get("c_T_base")) if isinstance(data, dict) else None
        if not isinstance(base, dict):
            return data
        base = base.get("c_T_base", base)
        missing = {"matrix_mm", "covariance_mm_deg"} - base.keys()
        if missing:
            raise ValueError(f"c_T_base: missing {min(missing)!r}")
        return data | {
            "c_T_base": base["matrix_mm"],
            "c_T_base_covariance_mm_deg": base["covariance_mm_deg"],
        }

    def base(self) -> UncertainPose:
        """C_T_B; exact when the file states no covariance."""
        covariance = self.c_T_base_covariance_mm_deg
        return UncertainPose(self.c_T_base, np.zeros((6, 6)) if covariance is None else covariance)

    def placements(self, entries: tuple[PlacementEntry, ...]) -> tuple[BoardPlacement, ...]:
        """The board before one head; raises ``BoardPoseInvalid``."""
        drawing = target_board_discs() if self.drawing_mm is None else self.drawing_mm
        return tuple(
            BoardPlacement(
                fit_board(drawing, [disc.point() for disc in entry.large_field]),
                fit_board(drawing, [disc.point() for disc in entry.head]),
            )
            for entry in entries
        )
