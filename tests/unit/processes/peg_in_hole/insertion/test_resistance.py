"""What holds a peg back on its way, sample by sample, in a bore of 100 N/mm."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.resistance import held_way_m, unrubbed_way_m
from cellctl.processes.peg_in_hole.plan.task import PartContacts
from tests.unit.processes.peg_in_hole.tasks import pin

FIT = pin(0.05, chamfer_mm=0.5).fit
STIFFNESS_N_M, FRICTION = 1e5, 0.2
MM = 1e-3


def felt(points: Sequence[tuple[float, float]], *, moment_n_m: float = 0.0) -> list[ContactSample]:
    """A feed along depths (mm) and forces against it (N), straight between them."""
    depth_mm = np.arange(points[0][0], points[-1][0], 5e-3)
    axial_n = np.interp(depth_mm, *np.array(points).T)
    noise_n = np.random.default_rng(1).normal(0.0, 0.1, len(depth_mm))
    return [
        ContactSample(
            0.008 * number,
            np.array([0.0, 0.0, depth * MM]),
            np.zeros(3),
            np.array([0.0, 0.0, -force]),
            np.array([0.0, moment_n_m, 0.0]),
            0.1,
        )
        for number, (depth, force) in enumerate(zip(depth_mm, axial_n + noise_n, strict=True))
    ]


def held_mm(feed: list[ContactSample], contacts: PartContacts | None = None) -> float:
    fit = replace(FIT, contacts=contacts)
    return held_way_m(feed, fit, FRICTION, STIFFNESS_N_M) / MM


def slipping(grip_n: float, way_mm: float) -> list[tuple[float, float]]:
    """Blocked by that way before the seat; the stop in the fingers is met where the seat is."""
    stands = 12.0 - way_mm
    slips = stands + 0.01 * grip_n
    return [
        (1.0, 0.5), (stands, 0.5), (slips, grip_n), (slips + way_mm, grip_n),
        (slips + way_mm + 0.01 * (18.0 - grip_n), 18.0),
    ]  # fmt: skip


@pytest.mark.parametrize("stiffness", [1.0, 0.5])
def test_a_seat_alone_holds_nothing_back(stiffness: float) -> None:
    # A softer one than the cell says takes a longer way, which its own rise explains.
    feed = felt([(1.0, 0.5), (12.0, 0.5), (12.0 + 0.18 / stiffness, 18.0)])
    assert abs(held_mm(feed)) < 0.05


@pytest.mark.parametrize("grip_n", [5.0, 8.7, 12.0, 15.0])
@pytest.mark.parametrize("way_mm", [0.4, 0.85, 3.0, 7.0])
def test_a_part_that_slips_to_a_stop_is_held_back_by_as_much(grip_n: float, way_mm: float) -> None:
    assert held_mm(felt(slipping(grip_n, way_mm))) == pytest.approx(way_mm, abs=0.1)


def test_friction_at_two_points_explains_itself() -> None:
    points = [(1.0, 0.5), (4.0, 6.0), (11.8, 6.0), (11.92, 18.0)]
    # As much moment as two contacts of a jam have at 6 N in the middle of the way.
    free, tilted = held_mm(felt(points)), held_mm(felt(points, moment_n_m=0.17))
    assert free > 7.0
    assert tilted < 0.1


def test_contacts_hold_a_part_back_from_their_depth_on_and_with_no_more_than_they_take() -> None:
    points = [(1.0, 0.5), (6.0, 0.5), (6.5, 40.0), (10.0, 30.0), (10.2, 50.0)]
    stated = PartContacts(6.0 * MM, 6.5 * MM, 25.0, 40.0)
    assert held_mm(felt(points), stated) < 0.05
    assert held_mm(felt(points)) > 3.0
    assert held_mm(felt(points), PartContacts(8.0 * MM, 8.5 * MM, 25.0, 40.0)) > 1.0
    assert held_mm(felt(points), PartContacts(6.0 * MM, 6.5 * MM, 10.0, 20.0)) > 1.0


def test_a_chamfer_does_not_count() -> None:
    points = [(0.0, 0.5), (0.05, 8.0), (0.9, 8.0), (0.95, 0.5), (12.0, 0.5), (12.18, 18.0)]
    assert held_mm(felt(points)) < 0.05


def test_a_moment_that_was_not_recorded_explains_nothing() -> None:
    feed = [replace(one, moment_n_m=np.full(3, np.nan)) for one in felt(slipping(8.7, 0.85))]
    assert held_mm(feed) == pytest.approx(0.85, abs=0.1)


PLUG = replace(FIT, contacts=PartContacts(6.0 * MM, 6.5 * MM, 25.0, 40.0), depth_m=10.0 * MM)


def test_a_plug_feels_its_contacts_on_its_way() -> None:
    points = [(1.0, 0.5), (6.0, 0.5), (6.9, 40.0), (10.2, 30.0), (10.4, 50.0)]
    assert unrubbed_way_m(felt(points), PLUG, STIFFNESS_N_M) == 0.0
    assert unrubbed_way_m(felt(points), FIT, STIFFNESS_N_M) is None


@pytest.mark.parametrize("grip_n", [5.0, 10.0, 20.0])
def test_a_plug_that_slips_before_its_contacts_does_not_feel_them(grip_n: float) -> None:
    # Blocked at 6 mm, and a stop in the fingers where the seat would be.
    slips = 6.0 + 0.01 * grip_n
    points = [(1.0, 0.5), (6.0, 0.5), (slips, grip_n), (10.0 + 0.01 * grip_n, grip_n)]
    feed = felt([*points, (10.0 + 0.5, 50.0)])
    found_m = unrubbed_way_m(feed, PLUG, STIFFNESS_N_M)
    assert found_m is not None
    # From 6.8 to 9.7 mm by the drawing.
    assert found_m / MM == pytest.approx(2.9, abs=0.1)
    assert held_way_m(feed, PLUG, FRICTION, STIFFNESS_N_M) / MM < 0.2
