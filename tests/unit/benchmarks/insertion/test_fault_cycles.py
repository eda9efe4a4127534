"""Faults of the campaigns are what they are called; traps are judged by run and by curve."""

import numpy as np
import pytest

from benchmarks.insertion.contact_traps import TrapState, run_contact_trap
from benchmarks.insertion.cycles import CycleCell
from benchmarks.insertion.fault_campaign import table as fault_table
from benchmarks.insertion.fault_cycles import EXPECTED, CycleFault, injected
from benchmarks.insertion.trap_campaign import table as trap_table


@pytest.fixture(scope="module")
def cell() -> CycleCell:
    return CycleCell.shipped("pin")


@pytest.mark.parametrize("fault", CycleFault)
def test_a_seed_makes_one_fault(cell: CycleCell, fault: CycleFault) -> None:
    first, again = injected(cell, fault, 3), injected(cell, fault, 3)
    assert first.world.fit == again.world.fit
    assert first.world.grip_n == again.world.grip_n
    assert first.sensor_delay_s == again.sensor_delay_s
    changed = (first.world.fit, first.world.grip_n, first.world.sensor, first.part)
    assert sum(one is not None for one in changed) == 1
    assert EXPECTED[fault]


def test_a_sensor_is_true_until_its_fault_begins(cell: CycleCell) -> None:
    sensor = injected(cell, CycleFault.SIGN, 1).world.sensor
    assert sensor is not None
    sample = np.arange(6.0)
    np.testing.assert_array_equal(sensor.tell(sample, 5.0), sample)
    sensor.begins_s = 4.0
    np.testing.assert_array_equal(sensor.tell(sample, 5.0), -sample)


@pytest.mark.figures
@pytest.mark.parametrize("seed", [1, 2])
def test_a_part_that_slips_to_a_stop_has_slipped(cell: CycleCell, seed: int) -> None:
    trap = run_contact_trap(cell, TrapState.SLIPS_TO_STOP, seed)
    assert (trap.inserted, trap.seated, trap.fault) == (False, False, "F591")
    assert trap.by_curve == "not inserted"


def test_a_frozen_sensor_ends_the_feed_and_nobody_calls_that_inserted(cell: CycleCell) -> None:
    trap = run_contact_trap(cell, TrapState.FROZEN, 5)
    assert not trap.inserted
    assert trap.fault == "F504"
    assert trap.by_curve in ("unknown", "not inserted")
    assert trap_table([trap]).row_count == 1
    assert fault_table([], []).row_count == 0
