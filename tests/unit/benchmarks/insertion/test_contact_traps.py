from benchmarks.insertion.contact_traps import TrapState, run_contact_trap
from benchmarks.insertion.farmed import pin_cell


def test_a_zero_that_jumps_in_the_rise_at_the_seat_neither_passes_nor_presses_on() -> None:
    trap = run_contact_trap(pin_cell(), TrapState.ZERO_JUMPS_AT_SEAT, 1)
    assert trap.seated, "by its place alone nothing speaks against it"
    assert not trap.inserted
    assert trap.fault == "F557"
    assert trap.by_curve != "inserted"
    assert trap.force_n < trap.limit_n
    assert trap.found == ()
