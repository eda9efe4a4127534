"""What every step of one assembly works with: devices, facts, measuring, moving, recording."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.guarded_motion.free_moves import free_tolerance
from cellctl.cell.guarded_motion.guarded_moves import WrenchTolerance, guarded_moves
from cellctl.cell.guarded_motion.settling import settle
from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.errors import CellError
from cellctl.geometry.pose import MM
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.mating.settings import FAST_LIMIT_N
from cellctl.processes.deck_to_frame.moves.hanging_load import flange_acceleration_m_s2
from cellctl.processes.deck_to_frame.moves.lift_off import NEAR_SPEED_M_S
from cellctl.processes.deck_to_frame.poses.part_measurer import (
    HeadGeometry,
    PartMeasurement,
    PartMeasurer,
)
from cellctl.processes.deck_to_frame.poses.pose_correction import Thresholds, target_M_T_D
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record.deck_recorder import DeckRecorder
from cellctl.processes.deck_to_frame.record.failed_picture import expected_rims
from cellctl.processes.deck_to_frame.record.keys import DECK, FRAME
from cellctl.processes.deck_to_frame.run_facts import RunFacts
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.process import CellServices, RunContext
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.steps import SafePoint, obey_hold
from cellctl.vision.features.feature_file import FeatureFile

_log = log.get(__name__)

SHARE_OF_ONE_PART = 0.6
"""Share of the uncertainty of the deck in the frame that one part may have. Frame and deck
contribute alike, which would allow each 0.71; what is left is for the movement of the heads between
them."""
SWING_RATIO = 2.0
"""A load that hangs on a spring pulls twice its mass times the acceleration when that begins."""
LEVER_M = 1.0
"""No centre of mass lies farther from the middle of its deck."""


@dataclass(frozen=True, slots=True)
class OpenRun:
    """What lasts over a whole run, however often its steps begin anew after a Hold."""

    facts: RunFacts
    board: ProgressBoard
    recorder: DeckRecorder
    """Numbers iterations and pictures through all beginnings."""
    safe_point: SafePoint
    interruption: Interruption
    exposures: RunExposures
    """Exposures of the heads, found once for a run: parts that are compared have to be measured in
    one light."""

    @classmethod
    def of(cls, facts: RunFacts, services: CellServices, context: RunContext) -> Self:
        """A run whose record was opened."""
        recorder = DeckRecorder(context.recorder, facts.cell.workers)
        exposures = RunExposures(facts.cell.cell, context.recorder)
        return cls(
            facts,
            services.board,
            recorder,
            context.safe_point,
            context.interruption,
            exposures,
        )


@dataclass(frozen=True, slots=True)
class AssemblyRun:
    """Devices, facts and the ways to measure, to move and to write down, from one beginning on."""

    opened: OpenRun
    measurer: PartMeasurer

    @property
    def facts(self) -> RunFacts:
        """Recipe, calibrations and drawings."""
        return self.opened.facts

    @property
    def board(self) -> ProgressBoard:
        """The board on which progress is shown."""
        return self.opened.board

    @property
    def recorder(self) -> DeckRecorder:
        """The recorder in which results are written down."""
        return self.opened.recorder

    @property
    def cell(self) -> DeckCell:
        """The devices."""
        return self.facts.cell

    async def obey_hold(self) -> None:
        """Pause if that is asked for; raises ``HeldMeanwhile`` when the cell was held."""
        await obey_hold(self.opened.safe_point)

    @property
    def recipe(self) -> DeckRecipe:
        """What is assembled."""
        return self.facts.recipe

    @property
    def target_M_T_D(self) -> RigidTransform:
        """Pose of the deck in the frame at the stand-off (eq. 5)."""
        return target_M_T_D(self.recipe.deck_thickness_mm * MM, self.recipe.stand_off_mm * MM)

    @property
    def thresholds(self) -> Thresholds:
        """Errors of the pose below which the deck may be mated (eq. 16)."""
        settings = self.recipe.pose_correction
        about_x, about_y, about_z = np.radians(settings.thresholds_deg).tolist()
        return Thresholds(settings.threshold_mm * MM, (about_x, about_y, about_z))

    @property
    def base_T_c1(self) -> RigidTransform:
        """Head I at its measuring pose."""
        return self.facts.geometry.base_T_c1.pose

    async def measure(
        self, features: FeatureFile, c1_T_part: RigidTransform, frames: int | None = None
    ) -> PartMeasurement:
        """Measure a part near a predicted pose, as certainly as the loop needs it.

        With at least so many ``frames``; those of the recipe unless said.
        """
        settings, thresholds = self.recipe.pose_correction, self.thresholds
        wanted = thresholds.vector * thresholds.uncertainty_share * SHARE_OF_ONE_PART
        try:
            return await self.measurer.measure(
                features,
                c1_T_part,
                frames=frames or settings.frames,
                max_frames=settings.max_frames,
                wanted_sigma_mm_deg=in_mm_deg(wanted),
            )
        except CellError as fault:
            await self._keep_seen(features, c1_T_part, fault)
            raise

    async def _keep_seen(
        self, features: FeatureFile, c1_T_part: RigidTransform, fault: CellError
    ) -> None:
        """Keep what the heads saw of a measurement that failed; no fault hides the first one."""
        part = FRAME if features is self.facts.frame_features else DECK
        try:
            heads = HeadGeometry.of(self.facts.geometry, self.recipe.pose_correction)
            expected = expected_rims(features, c1_T_part, heads)
            await self.recorder.failed_measurement(
                part, c1_T_part, self.measurer.seen, fault, expected
            )
        except CellError as second:
            fault.add_note(f"images not kept: {second}")
            _log.error("images not kept", fault=str(second))

    async def move_flange(
        self, base_T_flange: RigidTransform, flange_T_deck: RigidTransform
    ) -> None:
        """Straight move of the main robot under the guard, until the deck is still.

        Raises ``NotSettled``, and the fault of a trip: what the frame should be clear of is not.
        """
        main = self.cell.main_config
        speeds = main.linear_speed_mm_s, main.linear_acceleration_mm_s2
        # Nothing that was measured is near on this way, so the limit of a wanted contact does.
        await self._move(base_T_flange, flange_T_deck, *speeds, self.recipe.mating.limit_force_n)

    async def move_near_frame(
        self, base_T_flange: RigidTransform, flange_T_deck: RigidTransform
    ) -> None:
        """Move like ``move_flange``, but slowly and hardly felt: the frame is near.

        How near says the thickness of the deck, which nothing has measured yet: the first contact
        with the frame shows it. So it goes no faster than the deck leaves pins and edges, and any
        force beyond what acceleration makes of the payload stops it as in the fast travel.
        """
        mating = self.recipe.mating
        speed_mm_s = min(mating.fast_speed_mm_s, NEAR_SPEED_M_S / MM)
        speeds = speed_mm_s, mating.acceleration_mm_s2
        await self._move(base_T_flange, flange_T_deck, *speeds, FAST_LIMIT_N)

    async def _move(
        self,
        base_T_flange: RigidTransform,
        flange_T_deck: RigidTransform,
        speed_mm_s: float,
        acceleration_mm_s2: float,
        contact_n: float,
    ) -> None:
        # docs/mating.md, "Over the station": 200 kg at 200 mm/s² swing with 80 N, and what counts
        # as a contact comes on top.
        inertia_n = SWING_RATIO * self.facts.payload.mass_kg * acceleration_mm_s2 * MM
        force_n = inertia_n + contact_n
        tolerance = WrenchTolerance(force_n, force_n * LEVER_M)
        main, acceleration_m_s2 = self.cell.main, acceleration_mm_s2 * MM
        for_load_m_s2 = flange_acceleration_m_s2(
            main.state().base_T_flange, base_T_flange, flange_T_deck, acceleration_m_s2
        )
        slowest_m_s2 = min(acceleration_m_s2, main.least_acceleration_m_s2())
        # Somebody who ends this move has the controller brake harder than it accelerates, and that
        # shall not be taken for a contact.
        free = free_tolerance(self.cell.arm)
        braking = WrenchTolerance(free.force_n, free.moment_n_m + free.force_n * LEVER_M)
        async with guarded_moves(
            self.cell.cell, self.cell.arm, flange_T_deck, tolerance, braking=braking
        ) as move:
            await move(
                main.move_linear(
                    base_T_flange,
                    speed_m_s=speed_mm_s * MM,
                    acceleration_m_s2=max(for_load_m_s2, slowest_m_s2),
                )
            )
        # Two exposures of a deck that swung differed by 0.13 mm (docs/decisions/0005).
        await settle(self.cell.guard)
        await self.recorder.arrived(base_T_flange, self.cell.main.state().base_T_flange)
