"""What the steps of one assembly hand to each other."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_moves import Change, watched
from cellctl.cell.settling import settle
from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.journal import Journal
from cellctl.processes.deck_to_frame.measuring import PartMeasurement, PartMeasurer
from cellctl.processes.deck_to_frame.pose_correction import Thresholds, target_M_T_D
from cellctl.processes.deck_to_frame.recipe import Recipe
from cellctl.runtime.calibration_folder import Calibrations
from cellctl.runtime.commissioned import Commissioned
from cellctl.runtime.job import HeldMeanwhile, SafePoint
from cellctl.runtime.progress import ProgressBoard
from cellctl.vision.features import FeatureFile

SHARE_OF_ONE_PART = 1 / np.sqrt(2)
"""Frame and deck contribute alike to the uncertainty of the deck in the frame."""

SWING_RATIO = 2.0
"""A load that hangs on a spring pulls twice its mass times the acceleration when that begins."""
LEVER_M = 1.0
"""No centre of mass lies farther from the middle of its deck."""


@dataclass(slots=True)
class AssemblyRun:
    """One deck on one frame. The measured poses are filled in step by step."""

    cell: Cell
    recipe: Recipe
    calibrations: Calibrations
    commissioned: Commissioned
    payload_kg: float
    """Everything that hangs on the force sensor, as identified."""
    frame_features: FeatureFile
    deck_features: FeatureFile
    board: ProgressBoard
    journal: Journal
    pause: SafePoint
    measurer: PartMeasurer
    c1_T_M: UncertainPose | None = None
    """The frame, with the uncertainty of its own measurement."""
    flange_T_deck: RigidTransform | None = None
    M_T_D: UncertainPose | None = None
    """The deck as last measured."""
    measured_at: RigidTransform | None = None
    """``base_T_flange`` as reported while ``M_T_D`` was measured."""
    base_T_flange: RigidTransform | None = None
    """Commanded flange pose behind ``M_T_D``."""
    commanded: list[RigidTransform] = field(default_factory=list)
    """Every ``M_T_D`` commanded so far."""

    @property
    def target_M_T_D(self) -> RigidTransform:
        """Equation 5."""
        return target_M_T_D(self.recipe.deck_thickness_mm * MM, self.recipe.stand_off_mm * MM)

    @property
    def thresholds(self) -> Thresholds:
        """Equation 16."""
        settings = self.recipe.compensation
        return Thresholds(settings.threshold_mm * MM, float(np.radians(settings.threshold_deg)))

    @property
    def base_T_c1(self) -> RigidTransform:
        """Head I at its measuring pose."""
        return self.calibrations.geometry.base_T_c1.pose

    async def safe_point(self, *, hold: bool = False) -> None:
        """Obey a pending Hold, or with ``hold`` ask for one.

        Raises ``HeldMeanwhile`` when the cell was held: frame, deck and heads may have been moved
        since they were measured, and the deck hides the frame, so the run begins again.
        """
        if await self.pause(hold=hold):
            raise HeldMeanwhile

    async def measure(self, features: FeatureFile, c1_T_part: RigidTransform) -> PartMeasurement:
        """Measure a part near a predicted pose, as certainly as the loop needs it."""
        settings, thresholds = self.recipe.compensation, self.thresholds
        wanted = thresholds.vector * thresholds.uncertainty_share * SHARE_OF_ONE_PART
        return await self.measurer.measure(
            features,
            c1_T_part,
            frames=settings.frames,
            max_frames=settings.max_frames,
            wanted_sigma_mm_deg=in_mm_deg(wanted),
        )

    async def move_flange(self, base_T_flange: RigidTransform) -> None:
        """Straight move of the main robot under the guard, until the deck is still.

        Raises ``NotSettled``, and the fault of a trip: what the frame should be clear of is not.
        """
        main = self.cell.config.robots.main
        await self._move(base_T_flange, main.linear_speed_mm_s, main.linear_acceleration_mm_s2)

    async def lower_flange(self, base_T_flange: RigidTransform) -> None:
        """The same at the pace of the mating's fast travel, with limits as tight as that allows."""
        mating = self.recipe.mating
        await self._move(base_T_flange, mating.fast_speed_mm_s, mating.acceleration_mm_s2)

    async def _move(
        self, base_T_flange: RigidTransform, speed_mm_s: float, acceleration_mm_s2: float
    ) -> None:
        assert self.flange_T_deck is not None
        inertia_n = SWING_RATIO * self.payload_kg * acceleration_mm_s2 * MM
        force_n = inertia_n + self.recipe.mating.limit_force_n
        async with watched(self.cell, self.flange_T_deck, Change(force_n, force_n * LEVER_M)) as go:
            await go(
                self.cell.main.move_linear(
                    base_T_flange,
                    speed_m_s=speed_mm_s * MM,
                    acceleration_m_s2=acceleration_mm_s2 * MM,
                )
            )
        await settle(self.cell.guard)


StepFunction = Callable[[AssemblyRun], Awaitable[None]]
