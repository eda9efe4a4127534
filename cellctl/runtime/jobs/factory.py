"""Validates what a Start asks for, and makes the job when the unit starts."""

import asyncio
from collections.abc import Mapping
from datetime import timedelta
from typing import Any

from cellctl import log
from cellctl.calibration.store.kind import Kinds
from cellctl.cell.readiness import require_ready
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.internal import Unexpected
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.earlier_part import Warn
from cellctl.runtime.jobs.job import Job
from cellctl.runtime.jobs.maintenance import MaintenanceJob
from cellctl.runtime.jobs.production import ProductionJob
from cellctl.runtime.procedure import Procedure
from cellctl.runtime.process import CellServices, Process
from cellctl.runtime.steps import SafePoint

_log = log.get(__name__)

PLANNED = timedelta(minutes=30)
"""Calibrations must stay valid for this long after Start, so that none ends while a part is made. A
run takes minutes; the rest is room for a Hold, after which everything is measured again."""


class JobFactory:
    """Keeps the last accepted Start, and makes its job."""

    def __init__(
        self, services: CellServices, processes: Mapping[str, Process[Any, Any, Any]]
    ) -> None:
        self._services = services
        self._processes = processes
        self._procedures = procedures_by_number(processes)
        self._accepted: tuple[Mode, UnitCommand] | None = None

    async def validate(self, command: UnitCommand, mode: Mode) -> RejectCode:
        """Why Start is refused in Idle.

        The state machine itself refuses modes without Start, in other states the whole command.
        """
        # What is asked for comes first: an unknown recipe is the caller's mistake, and stays one
        # when the devices are ready.
        code = await self._validate_request(command, mode)
        if code is RejectCode.NONE:
            await self._services.store.look_for_room()
            code = _refused(*self._validate_cell())
        return code

    def ready(self, mode: Mode) -> bool:
        """Whether some Start in this mode would be taken; cheap, reads no files."""
        return self.refusal(mode) is RejectCode.NONE

    def refusal(self, mode: Mode) -> RejectCode:
        """Why no Start in this mode would be taken, whatever it asks for; cheap, reads no files."""
        if mode is Mode.PRODUCTION and not self._some_recipe_is_calibrated():
            return RejectCode.CALIBRATION_INVALID
        return self._validate_cell()[0]

    @property
    def procedures(self) -> Mapping[int, Procedure]:
        """All procedures of the cell by number."""
        return self._procedures

    def accept(self, command: UnitCommand, mode: Mode) -> None:
        """Remember a Start that was found good, right before the unit starts."""
        self._accepted = mode, command

    def job(self, safe_point: SafePoint, warn: Warn) -> Job:
        """A new job for the Start that was last accepted."""
        if self._accepted is None:
            raise Unexpected("the unit starts without an accepted Start")
        mode, command = self._accepted
        if mode is Mode.PRODUCTION:
            recipe = self._recipe(command.recipe_id)
            if recipe is None:
                raise Unexpected(f"recipe {command.recipe_id} vanished")
            process = self._processes[recipe.process]
            return ProductionJob(process, recipe, command, safe_point, warn)
        procedure = self._procedures.get(command.recipe_id)
        if procedure is None:
            raise Unexpected(f"procedure {command.recipe_id} vanished")
        return MaintenanceJob(self._services, procedure, command, safe_point)

    def _recipe(self, recipe_id: int) -> Recipe | None:
        return self._services.cell.config.recipe(recipe_id)

    async def _validate_request(self, command: UnitCommand, mode: Mode) -> RejectCode:
        """Why the recipe or procedure that a Start names cannot be run."""
        if mode is Mode.PRODUCTION:
            recipe = self._recipe(command.recipe_id)
            if recipe is None:
                return RejectCode.RECIPE_UNKNOWN
            # A clock that was set back would make calibrations valid again that have ended. The
            # newest entry of the run store shows it: no entry can be from the future.
            newest = await self._services.store.do(RunStore.newest_time)
            # In a thread, because it reads and checks files.
            fault = await asyncio.to_thread(
                self._services.calibrations.fault,
                self._kinds(recipe),
                PLANNED,
                newest,
            )
            return _refused(RejectCode.CALIBRATION_INVALID, fault)
        if mode is Mode.MAINTENANCE:
            if command.recipe_id not in self._procedures:
                return RejectCode.RECIPE_UNKNOWN
            if command.options:
                return RejectCode.OPTIONS_UNKNOWN  # a procedure is neither dry nor in steps
        return RejectCode.NONE

    def _some_recipe_is_calibrated(self) -> bool:
        store = self._services.calibrations
        return any(
            store.all_valid(self._kinds(recipe), PLANNED)
            for recipe in self._services.cell.config.recipes
        )

    def _kinds(self, recipe: Recipe) -> Kinds:
        """The calibrations that count for a recipe."""
        kinds = self._processes[recipe.process].calibration_kinds()
        return [kind.for_recipe(recipe.id) for kind in kinds]

    def _validate_cell(self) -> tuple[RejectCode, CellError | None]:
        """Why no Start at all is taken now."""
        if self._services.store.refusal is not None:
            return RejectCode.RECORDS_NOT_READY, self._services.store.refusal
        cell = self._services.cell
        try:
            require_ready(cell.robots.values())
            for guard in cell.guards.values():
                guard.check()
            for fault in cell.unanswered.values():
                return RejectCode.DEVICE_NOT_READY, fault
        except CellError as error:
            return RejectCode.DEVICE_NOT_READY, error
        return RejectCode.NONE, None


def procedures_by_number(processes: Mapping[str, Process[Any, Any, Any]]) -> dict[int, Procedure]:
    """Every procedure of the cell.

    Raises ``Unexpected`` when two processes of one cell give a number to different procedures:
    the line could not tell them apart.
    """
    found: dict[int, Procedure] = {}
    for name, process in processes.items():
        for procedure in process.procedures():
            if procedure.number in found:
                raise Unexpected(f"procedure {procedure.number} of {name} exists already")
            found[procedure.number] = procedure
    return found


def _refused(code: RejectCode, fault: CellError | None) -> RejectCode:
    if fault is None:
        return RejectCode.NONE
    _log.warning("Start refused", number=fault.number, fault=str(fault))
    return code
