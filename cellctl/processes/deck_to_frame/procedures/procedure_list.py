"""Procedures 101 to 109: the generic ones with this process's devices, and its own."""

from collections.abc import Awaitable, Callable, Sequence
from datetime import timedelta
from functools import partial

import numpy as np

from cellctl.calibration.boards.board import CalibrationBoard
from cellctl.calibration.solvers.base_frame.base_frame import ArmGeometry
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.cell.guarded_motion.free_moves import free_tolerance, guarded_section
from cellctl.cell.stereo_station import StereoStation
from cellctl.config.driver_settings import first_link_mm
from cellctl.geometry.pose import MM
from cellctl.procedures.arm_reference import check_arm_reference
from cellctl.procedures.base_frame import FLANGE_TARGETS, AxisTurns, calibrate_base
from cellctl.procedures.payload import identify_payload_on_cell
from cellctl.procedures.stereo_head import calibrate_head
from cellctl.procedures.stop_latency import measure_stop_latency_on_cell
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    PAYLOAD,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
    STOP_LATENCY,
)
from cellctl.processes.deck_to_frame.moves.taught_poses import main_to_home
from cellctl.processes.deck_to_frame.procedures import guides
from cellctl.processes.deck_to_frame.procedures.board_transfer import (
    WaitingPlacements,
    measure_board,
)
from cellctl.processes.deck_to_frame.procedures.clear_cell import clear_the_cell
from cellctl.processes.deck_to_frame.procedures.contact_stiffness import (
    measure_contact_stiffness_on_cell,
)
from cellctl.processes.deck_to_frame.procedures.empty_gripper import require_no_deck
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.guide import Guide
from cellctl.runtime.procedure import Procedure, ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices

STIFFNESS_BY_RECIPE = 10_800
"""Plus the number of a recipe: contact stiffness of its parts; 108 means the first recipe."""
STIFFNESS = 108

Run = Callable[[ProcedureContext], Awaitable[ProcedureOutcome | None]]


def deck_procedures(
    cell: DeckCell, services: CellServices, waiting: WaitingPlacements
) -> Sequence[Procedure]:
    """All procedures of the cell whose devices are given."""
    valid_for = timedelta(days=cell.settings.validity_days)
    on_cell = _OnCell(cell, services, waiting)

    def procedure(number: int, label: str, guide: Guide, run: Run) -> Procedure:
        return Procedure(number, number, label, run, valid_for, guide=guide)

    head_1 = partial(on_cell.head, cell.head_1, STEREO_HEAD_1)
    head_2 = partial(on_cell.head, cell.head_2, STEREO_HEAD_2)
    return (
        procedure(101, "calibrate head 1", guides.HEAD_1, head_1),
        procedure(102, "calibrate head 2", guides.HEAD_2, head_2),
        procedure(103, "calibrate base frame", guides.BASE, on_cell.base_frame),
        procedure(104, "calibrate board 1", guides.BOARD_1, partial(on_cell.board, HEAD_1)),
        procedure(105, "calibrate board 2", guides.BOARD_2, partial(on_cell.board, HEAD_2)),
        procedure(106, "identify payload", guides.WEIGHING, on_cell.payload),
        procedure(107, "measure stop latency", guides.STOPPING, on_cell.stop_latency),
        *_contact_stiffness(cell, services, valid_for),
        procedure(109, "check main arm", guides.REFERENCE, on_cell.main_arm),
    )


def _contact_stiffness(
    cell: DeckCell, services: CellServices, valid_for: timedelta
) -> Sequence[Procedure]:
    recipes = {STIFFNESS: cell.recipes[0]}
    recipes |= {STIFFNESS_BY_RECIPE + recipe.id: recipe for recipe in cell.recipes}
    return [
        Procedure(
            number,
            STIFFNESS,
            "measure contact stiffness",
            partial(measure_contact_stiffness_on_cell, cell, recipe, services),
            valid_for,
            contact=True,
            guide=guides.stiffness(recipe.id),
        )
        for number, recipe in recipes.items()
    ]


class _OnCell:
    """Each procedure with everything out of its way."""

    def __init__(self, cell: DeckCell, services: CellServices, waiting: WaitingPlacements) -> None:
        self._cell, self._services, self._waiting = cell, services, waiting

    async def head(
        self,
        station: StereoStation,
        kind: CalibrationKind[StereoResult],
        context: ProcedureContext,
    ) -> ProcedureOutcome:
        """Procedures 101 and 102: the cameras of a head."""
        settings = self._cell.settings
        columns, rows = (int(number) for number in settings.board.split("x"))
        board = CalibrationBoard(columns, rows, settings.square_mm * MM)
        await self._without_deck(context, measuring=station)
        return await calibrate_head(
            context,
            station,
            self._cell.workers,
            board=board,
            view_count=settings.stereo_views,
            kind=kind,
        )

    async def base_frame(self, context: ProcedureContext) -> ProcedureOutcome:
        """Procedure 103: the base frame."""
        cell, settings, main = self._cell, self._cell.settings, self._cell.main_config
        turns = AxisTurns(
            start_rad=np.radians(settings.base_frame_joints_deg),
            arc_deg=settings.circle_arc_deg,
            stops=settings.circle_stops,
            speed_ratio=main.speed_percent / 100,
            frames=settings.tracker_frames,
        )
        d1_mm, a1_mm = first_link_mm(main)
        assert d1_mm is not None  # by the check of the cell file
        assert a1_mm is not None  # likewise
        arm = ArmGeometry(d1_m=d1_mm * MM, a1_m=a1_mm * MM)
        await self._without_deck(context)
        async with guarded_section(cell.arm, free_tolerance(cell.arm)):
            return await calibrate_base(
                context,
                cell.main,
                cell.tracker,
                cell.workers,
                turns=turns,
                arm=arm,
                kind=BASE_FRAME,
                go_home=partial(main_to_home, cell),
            )

    async def main_arm(self, context: ProcedureContext) -> None:
        """109: where 103 ended, so that the way there and home is that of 103."""
        cell = self._cell
        reference = self._services.calibrations.read(BASE_FRAME).reference
        await self._without_deck(context)
        async with guarded_section(cell.arm, free_tolerance(cell.arm)):
            await check_arm_reference(
                context,
                cell.main,
                cell.tracker,
                reference,
                speed_ratio=cell.main_config.speed_percent / 100,
                frames=cell.settings.tracker_frames,
                target_prefix=FLANGE_TARGETS,
                go_home=partial(main_to_home, cell),
            )

    async def _without_deck(
        self, context: ProcedureContext, *, measuring: StereoStation | None = None
    ) -> None:
        """Clear the cell as for a run, and make sure that no deck is held: its space is needed."""
        await clear_the_cell(self._cell, context.board, measuring=measuring)
        await require_no_deck(self._cell, self._services)

    async def board(self, head: str, context: ProcedureContext) -> ProcedureOutcome | None:
        """Procedures 104 and 105: the boards of both heads."""
        cell, calibrations = self._cell, self._services.calibrations
        await clear_the_cell(cell, context.board, measuring=cell.head(head))
        return await measure_board(context, cell, head, calibrations, self._waiting)

    async def payload(self, context: ProcedureContext) -> ProcedureOutcome:
        """106: home holds the deck in the mating orientation, high above the frame."""
        cell, settings = self._cell, self._cell.settings
        await clear_the_cell(cell, context.board)
        async with guarded_section(cell.arm, free_tolerance(cell.arm)):
            return await identify_payload_on_cell(
                context,
                cell.arm,
                cell.workers,
                pose_count=settings.payload_poses,
                cone_deg=settings.payload_cone_deg,
                kind=PAYLOAD,
            )

    async def stop_latency(self, context: ProcedureContext) -> ProcedureOutcome:
        """Procedure 107: the stop latency."""
        cell = self._cell
        await clear_the_cell(cell, context.board)
        # A result must fit every recipe that it will be used for, so the least bound decides.
        bound_ms = min(recipe.mating.stop_latency_ms for recipe in cell.recipes)
        async with guarded_section(cell.arm, free_tolerance(cell.arm)):
            return await measure_stop_latency_on_cell(
                context, cell.main, cell.workers, bound_ms=bound_ms, kind=STOP_LATENCY
            )
