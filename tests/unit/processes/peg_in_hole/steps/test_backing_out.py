import asyncio

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactMotion, Ended
from cellctl.errors.base import CellError
from cellctl.errors.robot import StreamNotOffered
from cellctl.errors.streamed_contact import AdmittanceSaturated, ContactLost, StreamLate
from cellctl.processes.peg_in_hole.faults import (
    FalseSeat,
    HoleAbsent,
    HoleBlocked,
    HoleTooWide,
    NotSeated,
    PegJammed,
    PegSlipped,
    PegWedged,
    SearchGaveUp,
    SensorDead,
)
from cellctl.processes.peg_in_hole.steps.backing_out import back_out_after
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth
from tests.unit.processes.peg_in_hole.tasks import pin

DEEP_M = 4e-3


class InTheHole(KinematicMotions):
    """A peg that stands in its hole, free or held."""

    def __init__(self, *, held: bool = False) -> None:
        super().__init__(pin(), Truth(np.zeros(2), np.zeros(2)), np.random.default_rng(0))
        self.position_m[2], self.held = DEEP_M, held

    async def back_out(self, height_m: float) -> ContactMotion:
        motion = await super().back_out(height_m)
        return ContactMotion(Ended.FORCE, motion.samples) if self.held else motion


@pytest.mark.parametrize(
    "fault",
    [
        HoleAbsent, SearchGaveUp, PegJammed, HoleBlocked, NotSeated, FalseSeat, HoleTooWide,
        ContactLost, AdmittanceSaturated,
    ],
)  # fmt: skip
def test_the_peg_is_drawn_out_well_clear_of_the_face(fault: type[CellError]) -> None:
    motions = InTheHole()
    assert asyncio.run(back_out_after(fault("4.0 mm"), motions)) == "the peg was drawn out"
    assert motions.position_m[2] == pytest.approx(-10e-3)


@pytest.mark.parametrize(
    "fault", [PegWedged, PegSlipped, SensorDead, StreamLate, StreamNotOffered, CellError]
)
def test_the_peg_stays_where_a_pull_could_do_harm_or_would_not_be_felt(
    fault: type[CellError],
) -> None:
    motions = InTheHole()
    told = asyncio.run(back_out_after(fault("4.0 mm"), motions))
    assert told == "the peg is left where it stands"
    assert motions.position_m[2] == DEEP_M


def test_a_peg_that_is_held_on_its_way_out_is_told() -> None:
    told = asyncio.run(back_out_after(PegJammed("4.0 mm"), InTheHole(held=True)))
    assert told == "something holds the peg back"


def test_what_fails_on_the_way_out_does_not_hide_what_became_of_the_part() -> None:
    """A jammed part is a bad one, whatever the arm does then."""

    class Late(InTheHole):
        async def back_out(self, height_m: float) -> ContactMotion:
            raise StreamLate(f"to {height_m}")

    fault = PegJammed("4.0 mm")
    assert asyncio.run(back_out_after(fault, Late())) == "the peg is left where it stands"
    assert any("F587" in note or StreamLate.text in note for note in fault.__notes__)
