"""The kinds of this process fit what they name: procedures, registers, roles, documents."""

from pathlib import Path
from typing import Any

import pytest

from cellctl.api.modbus.register_map import VALIDITY_REGISTERS
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.processes.deck_to_frame.calibrations import BOARD_TRANSFER, CALIBRATIONS
from cellctl.processes.deck_to_frame.procedures.board_transfer import WaitingPlacements
from cellctl.processes.deck_to_frame.procedures.procedure_list import deck_procedures
from cellctl.processes.deck_to_frame.roles import ROLES
from tests.unit.processes.deck_to_frame.rig import RunRig

DOCUMENT = Path(__file__).parents[4] / "docs" / "calibration.md"

every_kind = pytest.mark.parametrize("kind", CALIBRATIONS, ids=lambda kind: kind.name)


def test_every_kind_is_made_by_procedures_that_exist(rig: RunRig) -> None:
    services: Any = None  # procedures use them only when they run
    offered = deck_procedures(rig.bench.deck, services, WaitingPlacements())
    numbers = {number for kind in CALIBRATIONS for number in kind.procedures}
    only_checks = {109}
    assert numbers | only_checks == {procedure.step for procedure in offered}


@every_kind
def test_registers_and_devices_exist(kind: CalibrationKind[Any]) -> None:
    assert kind.register is None or kind.register in VALIDITY_REGISTERS
    assert kind.device is None or kind.device in ROLES


def test_every_register_shows_some_kind() -> None:
    assert {kind.register for kind in CALIBRATIONS} - {None} == set(VALIDITY_REGISTERS)


def test_only_the_board_transfer_holds_for_taught_poses() -> None:
    assert [kind for kind in CALIBRATIONS if kind.holds_for] == [BOARD_TRANSFER]


@every_kind
def test_the_document_lists_it(kind: CalibrationKind[Any]) -> None:
    name = f"{kind.name}_<recipe id>" if kind.per_recipe else kind.name
    procedures = ", ".join(str(number) for number in kind.procedures)
    register, device = (f"`{text}`" if text else "–" for text in (kind.register, kind.device))
    faults = ", ".join(sorted(f"F{fault.number}" for fault in kind.invalidated_by)) or "–"
    row = f"| `{name}` | {procedures} | {register} | {device} | {faults} |"
    assert row in DOCUMENT.read_text(encoding="utf-8")
