"""Measures a part with both heads: takes images until the pose is certain enough."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.gather import gather_or_cancel
from cellctl.cell.image_faults import naming
from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.cell.standstill import require_unmoved
from cellctl.cell.stereo_station import StereoStation
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import StereoPair
from cellctl.processes.deck_to_frame.faults import UncertaintyTooLarge
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from cellctl.processes.deck_to_frame.recipe import PoseCorrection
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.feature_file import FeatureFile
from cellctl.vision.features.hole import Hole
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import Method, PairMeasurement
from cellctl.vision.registration.average import average
from cellctl.vision.registration.part_pose import PartPose, part_pose
from cellctl.vision.registration.relative_pose import RelativePose, relative_pose

_log = log.get(__name__)


@dataclass(frozen=True, slots=True)
class HeadGeometry:
    """What calibration says about the two heads at the measuring poses that it was made at."""

    head_1: StereoHead
    head_2: StereoHead
    c1_T_c2: UncertainPose
    """The transform between the heads, with the drift since its calibration in its covariance."""
    sway_m: float = 0.0
    """How far the arms that carry the heads sway in one picture: standard deviation, each axis."""

    @classmethod
    def of(cls, calibrations: CalibrationSet, settings: PoseCorrection) -> Self:
        """The geometry as calibrated, with ``c1_T_c2`` as uncertain as it is after the drift that
        may have been."""
        drift = np.repeat([settings.heads_drift_mm * MM, np.radians(settings.heads_drift_deg)], 3)
        calibrated = calibrations.c1_T_c2
        c1_T_c2 = UncertainPose(calibrated.pose, calibrated.covariance + np.diag(drift**2))
        return cls(*calibrations.heads, c1_T_c2, settings.heads_sway_mm * MM)

    def camera_T_part(self, c1_T_part: RigidTransform) -> tuple[RigidTransform, RigidTransform]:
        """A pose predicted in head I, for both heads."""
        return c1_T_part, self.c1_T_c2.pose.inv() * c1_T_part


@dataclass(frozen=True, slots=True)
class SeenPair:
    """What one head saw, whatever came of it."""

    frame: int
    """Number of the exposure, from 1 on."""
    head: int
    """Number of the head, 1 or 2."""
    pair: StereoPair
    found: PairMeasurement | None = None
    """The holes that were measured in it; None where that failed or was not tried."""


@dataclass(frozen=True, slots=True)
class PartMeasurement:
    """A part measured by both heads, with what is needed to show and to repeat it."""

    pose: PartPose
    """``c1_T_part`` with covariance and residuals."""
    heads: tuple[PairMeasurement, PairMeasurement]
    pairs: tuple[StereoPair, StereoPair]
    """The last images of each head."""
    frames: int
    base_T_flange: RigidTransform
    """Main robot, as reported while the images were taken."""
    predicted: RigidTransform | None = None
    """``c1_T_part`` near which the holes were looked for; None where nobody looked."""
    shots: tuple[tuple[StereoPair, StereoPair], ...] = ()
    """The images of both heads of every frame, the oldest first."""

    @property
    def c1_T_part(self) -> RigidTransform:
        """The pose alone."""
        return self.pose.pose.pose

    @property
    def sigma_mm_deg(self) -> Array:
        """Standard deviations x, y, z in mm and rx, ry, rz in degrees, of the images alone.

        In the axes of the part, as the thresholds are. They say whether more frames help. The error
        of C1_T_C2, and what the part is off its drawing, stay with any number of frames.
        """
        into_part = np.kron(np.eye(2), self.c1_T_part.rotation.inv().as_matrix())
        sigma = np.sqrt(np.diag(into_part @ self.pose.image_covariance @ into_part.T))
        return np.concatenate([sigma[:3] / MM, np.degrees(sigma[3:])])


def deck_in_frame(
    frame: PartPose, deck: PartPose, geometry: HeadGeometry, method: Method
) -> RelativePose:
    """Measured ``M_T_D`` with its covariance (eq. 9).

    Default: both parts and the movement of the heads since their calibration are estimated
    together (docs/metrology.md, "Deck against frame"). ``"paper"``: the poses of the parts, each
    for itself.
    """
    c1_T_M, c1_T_D = frame.pose.pose, deck.pose.pose
    if method == "paper":
        own = UncertainPose(c1_T_M, frame.own_covariance).inv()
        M_T_D = own * UncertainPose(c1_T_D, deck.own_covariance)
        return RelativePose(M_T_D, np.zeros(6), deck.misfit)
    known = geometry.c1_T_c2.covariance
    sway_m = geometry.sway_m
    return relative_pose(frame.points, deck.points, c1_T_M, c1_T_D, known, sway_m=sway_m)


class PartMeasurer:
    """Measures parts with the heads standing still; remembers where they stood at first."""

    def __init__(
        self, cell: DeckCell, geometry: HeadGeometry, method: Method, exposures: RunExposures
    ) -> None:
        self._cell = cell
        self._exposures = exposures
        self._geometry = geometry
        self._method = method
        self._reference = [head.robot.state().base_T_flange for head in cell.heads]
        self.seen: list[SeenPair] = []
        """Images of the measurement that goes on, or that has failed."""

    def deck_in_frame(self, frame: PartPose, deck: PartPose) -> RelativePose:
        """``M_T_D`` of two parts that these heads have measured."""
        return deck_in_frame(frame, deck, self._geometry, self._method)

    async def measure(
        self,
        features: FeatureFile,
        c1_T_part: RigidTransform,
        *,
        frames: int,
        max_frames: int,
        wanted_sigma_mm_deg: Array,
    ) -> PartMeasurement:
        """Measure a part near a predicted pose.

        Takes ``frames`` pairs, then more until every standard deviation is below the wanted one;
        raises ``UncertaintyTooLarge`` after ``max_frames``, ``HeadMoved`` when a head or the main
        robot moved while the pictures were taken, the faults of ``cellctl.vision`` when holes
        are missing or do not fit, and before the first part of a run those of its exposures.
        """
        self.seen = []
        predictions = self._geometry.camera_T_part(c1_T_part)
        base_T_flange = self._cell.main.state().base_T_flange
        await gather_or_cancel(*(self._exposures.find(head.camera) for head in self._cell.heads))
        taken: list[tuple[PairMeasurement, PairMeasurement]] = []
        shots: list[tuple[StereoPair, StereoPair]] = []
        while True:
            # As many again as there are: the standard deviation falls with the root of their
            # number, so that one frame more would change next to nothing.
            wanted = min(len(taken) or frames, max_frames - len(taken))
            for _ in range(wanted):
                pairs, found = await self._one_frame(features, predictions)
                taken.append(found)
                shots.append(pairs)
            # After the last picture, so that a move during any of them is noticed.
            self._check_standstill(base_T_flange)
            measurement = self._combine(features, taken, pairs, base_T_flange)
            if (measurement.sigma_mm_deg <= wanted_sigma_mm_deg).all():
                self.seen = []
                return replace(measurement, predicted=c1_T_part, shots=tuple(shots))
            if len(taken) >= max_frames:
                raise UncertaintyTooLarge(_sigma_text(measurement, wanted_sigma_mm_deg))
            _log.info("more frames needed", sigma=measurement.sigma_mm_deg.round(5).tolist())

    async def _one_frame(
        self, features: FeatureFile, predictions: tuple[RigidTransform, RigidTransform]
    ) -> tuple[tuple[StereoPair, StereoPair], tuple[PairMeasurement, PairMeasurement]]:
        stations = self._cell.heads
        models = (self._geometry.head_1, self._geometry.head_2)
        holes = (features.seen_by(1), features.seen_by(2))
        # Both heads at once: what sways in this moment sways in the pictures of both, and of the
        # pose of the part in C1 only their difference is left.
        results = await gather_or_cancel(
            *(
                self._grab_and_find(station, model, hole, prediction)
                for station, model, hole, prediction in zip(
                    stations, models, holes, predictions, strict=True
                )
            )
        )
        return (results[0][0], results[1][0]), (results[0][1], results[1][1])

    async def _grab_and_find(
        self,
        station: StereoStation,
        model: StereoHead,
        holes: Sequence[Hole],
        camera_T_part: RigidTransform,
    ) -> tuple[StereoPair, PairMeasurement]:
        pair = await station.camera.grab()
        # Before anything is looked for: what is not found must be seen in the record.
        head = self._cell.heads.index(station) + 1
        frame = 1 + sum(one.head == head for one in self.seen)
        place, seen = len(self.seen), SeenPair(frame, head, pair)
        self.seen.append(seen)
        with naming(station.name):
            found = await self._cell.workers.run(
                measure_pair,
                pair.left,
                pair.right,
                model,
                holes,
                camera_T_part=camera_T_part,
                method=self._method,
            )
        self.seen[place] = replace(seen, found=found)
        return pair, found

    def _combine(
        self,
        features: FeatureFile,
        taken: Sequence[tuple[PairMeasurement, PairMeasurement]],
        pairs: tuple[StereoPair, StereoPair],
        base_T_flange: RigidTransform,
    ) -> PartMeasurement:
        heads, pose = combined(features, taken, self._geometry, self._method)
        return PartMeasurement(pose, heads, pairs, len(taken), base_T_flange)

    def _check_standstill(self, base_T_flange: RigidTransform) -> None:
        for head, reference in zip(self._cell.heads, self._reference, strict=True):
            require_unmoved(head.name, head.robot, reference)
        require_unmoved("the main robot", self._cell.main, base_T_flange)


def combined(
    features: FeatureFile,
    taken: Sequence[tuple[PairMeasurement, PairMeasurement]],
    geometry: HeadGeometry,
    method: Method,
) -> tuple[tuple[PairMeasurement, PairMeasurement], PartPose]:
    """The holes of both heads, averaged over the frames, and the pose of the part from them."""
    heads = (average([one for one, _ in taken]), average([two for _, two in taken]))
    return heads, part_pose(*heads, geometry.c1_T_c2, features.holes, method)


def _sigma_text(measurement: PartMeasurement, wanted: Array) -> str:
    got = ", ".join(f"{value:.4f}" for value in measurement.sigma_mm_deg)
    limit = ", ".join(f"{value:.4f}" for value in wanted)
    return f"after {measurement.frames} frames σ = ({got}) mm/deg, needed ({limit})"
