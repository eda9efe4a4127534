"""Where heads, base and large-field head are, according to the calibrations of this process."""

from dataclasses import dataclass

from cellctl.calibration.solvers.base_frame.base_frame import BaseFrameResult
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.calibration.solvers.transfer.board_transfer import TransferResult
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
)
from cellctl.vision.camera.stereo_head import StereoHead


@dataclass(frozen=True, slots=True)
class CalibrationSet:
    """The results that together say where everything is; the payload is not among them."""

    head_1: StereoResult
    head_2: StereoResult
    base_frame: BaseFrameResult
    transfer: TransferResult

    @classmethod
    def of(cls, snapshot: CalibrationSnapshot) -> "CalibrationSet":
        """The geometry in a snapshot; raises ``CalibrationMissing`` when a part is not there."""
        return cls(
            head_1=snapshot.get(STEREO_HEAD_1),
            head_2=snapshot.get(STEREO_HEAD_2),
            base_frame=snapshot.get(BASE_FRAME),
            transfer=snapshot.get(BOARD_TRANSFER),
        )

    @property
    def heads(self) -> tuple[StereoHead, StereoHead]:
        """Cameras of head I and head II."""
        return self.head_1.head, self.head_2.head

    @property
    def c_T_base(self) -> UncertainPose:
        """Base of the main robot in the large-field head."""
        return self.base_frame.c_T_base

    @property
    def base_T_c1(self) -> UncertainPose:
        """Head I in the base."""
        return self.transfer.base_T_c1

    @property
    def base_T_c2(self) -> UncertainPose:
        """Head II in the base."""
        return self.transfer.base_T_c2

    @property
    def c1_T_c2(self) -> UncertainPose:
        """Head II in head I."""
        return self.transfer.c1_T_c2
