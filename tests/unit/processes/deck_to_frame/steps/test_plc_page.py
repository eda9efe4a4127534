"""The page for the line's programmer lists the steps of this process as they are."""

import re
from pathlib import Path
from typing import cast

from cellctl.processes.deck_to_frame.procedures.board_transfer import WaitingPlacements
from cellctl.processes.deck_to_frame.procedures.procedure_list import deck_procedures
from cellctl.processes.deck_to_frame.steps import ASSEMBLY
from cellctl.records.async_store import AsyncRunStore
from cellctl.runtime.process import CellServices
from cellctl.runtime.progress import ProgressBoard
from tests.unit.cell.bench import Bench

PAGE = Path(__file__).parents[5] / "docs/plc-integration.md"


def test_the_steps_are_listed(bench: Bench) -> None:
    no_store = cast(AsyncRunStore, None)  # nothing is run
    services = CellServices(bench.as_cell, bench.calibrations, ProgressBoard(), no_store)
    procedures = deck_procedures(bench.deck, services, WaitingPlacements())
    steps = {(step.number, step.label) for step in ASSEMBLY.specs}
    steps |= {(procedure.step, procedure.label) for procedure in procedures}
    rows = re.findall(r"^\| (\d+) \| ([^|]+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert {(int(number), name.strip()) for number, name in rows} == {(0, "none"), *steps}
