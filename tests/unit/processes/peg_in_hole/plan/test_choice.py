from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.processes.peg_in_hole.faults import HeightTooNoisy, SearchImpossible
from cellctl.processes.peg_in_hole.plan.choice import (
    SearchName,
    choose_search,
    estimate_searches,
    is_wide,
)
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters, touch_speed_m_s
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from tests.unit.processes.peg_in_hole.tasks import pin, plug


@pytest.mark.parametrize(
    ("stiffness_n_m", "speed_mm_s"), [(1e5, 1.5), (1e6, 0.15), (3e6, 0.05), (1e7, 0.015)]
)
def test_touch_speeds_of_the_reference(stiffness_n_m: float, speed_mm_s: float) -> None:
    assert touch_speed_m_s(stiffness_n_m, 24e-3) * 1e3 == pytest.approx(speed_mm_s, rel=0.03)


@pytest.mark.parametrize(
    ("task", "name", "seconds"),
    [
        (pin(uncertainty_m=2e-3), SearchName.TILTED_VALLEY, 65),
        (pin(uncertainty_m=2e-3, stiffness_n_m=1e5), SearchName.TILTED_VALLEY, 14),
        (pin(uncertainty_m=5e-3), SearchName.TILTED_VALLEY, 72),
        (plug(uncertainty_m=5e-3), SearchName.SPIRAL, 21),
    ],
)
def test_estimates_of_the_reference(task: SearchTask, name: SearchName, seconds: float) -> None:
    estimates = estimate_searches(task, search_parameters(task))
    assert estimates[name].value == pytest.approx(seconds, rel=0.05)


@pytest.mark.parametrize(
    ("task", "first"),
    [
        (pin(chamfer_mm=0.5), SearchName.SPIRAL),
        (pin(), SearchName.TILTED_VALLEY),
        (plug(uncertainty_m=5e-3), SearchName.SPIRAL),
        (plug(0.05, chamfer_mm=0, uncertainty_m=5e-3), SearchName.ARC),
    ],
)
def test_the_default_follows_from_the_geometry(task: SearchTask, first: SearchName) -> None:
    assert choose_search(task).order[0] is first


def test_a_spiral_takes_the_place_of_a_valley_that_would_take_too_long() -> None:
    # A thick pin on a stiff arm: the slides of a valley are as long as its radius.
    task = pin(0.06, stiffness_n_m=7e5, dead_time_s=35e-3, uncertainty_m=1.5e-3)
    thick = replace(task, fit=replace(task.fit, peg_radius_m=9.6e-3))
    choice = choose_search(thick)
    assert choice.estimates[SearchName.TILTED_VALLEY].value > thick.search_limit_s
    assert choice.order == (SearchName.SPIRAL, SearchName.PARTICLE_MAP)


@pytest.mark.parametrize("stiffness_n_m", [3e6, 1e7])
def test_a_tight_hole_is_refused_by_a_stiff_cell(stiffness_n_m: float) -> None:
    with pytest.raises(SearchImpossible, match="k θ is"):
        choose_search(pin(stiffness_n_m=stiffness_n_m))


def test_a_chamfered_hole_is_not_refused_by_a_stiff_cell() -> None:
    assert choose_search(pin(chamfer_mm=0.5, stiffness_n_m=1e7)).order[0] is SearchName.SPIRAL


def test_a_plain_spiral_is_refused_on_a_tight_hole_with_its_estimate() -> None:
    with pytest.raises(SearchImpossible, match=r"spiral: \d+ s; the search may take 110 s"):
        choose_search(pin(), SearchName.SPIRAL)


def test_the_patent_is_refused_on_a_plate() -> None:
    with pytest.raises(SearchImpossible, match="no outer face"):
        choose_search(pin(), SearchName.PATENT_MIDPOINT)


def test_noisy_heights_refuse_tilted_touches() -> None:
    with pytest.raises(HeightTooNoisy, match="standard deviations"):
        choose_search(pin(height_sigma_m=0.05e-3))


def test_every_parameter_says_where_it_comes_from() -> None:
    record = choose_search(pin()).to_record()
    assert len(record["parameters"]) == 15
    assert all(entry["formula"] for entry in record["parameters"] + record["estimates"])


@given(
    st.floats(1e5, 1e7),
    st.floats(6e-3, 60e-3),
    st.floats(0.01, 0.2),
    st.floats(1e-3, 8e-3),
)
def test_every_task_is_planned_or_refused_with_figures(
    stiffness_n_m: float, dead_time_s: float, clearance_mm: float, uncertainty_m: float
) -> None:
    task = pin(
        clearance_mm,
        stiffness_n_m=stiffness_n_m,
        dead_time_s=dead_time_s,
        uncertainty_m=uncertainty_m,
    )
    refusal, slowest_s = "", 0.0
    try:
        choice = choose_search(task)
        slowest_s = max(choice.estimates[name].value for name in choice.order)
    except SearchImpossible as refused:
        refusal = refused.detail
    if task.cell.loop_n_s_m > 7e4 and not is_wide(task):
        assert refusal.startswith("k θ is")
    else:
        assert slowest_s <= task.search_limit_s
        assert not refusal or f"may take {task.search_limit_s:.0f} s" in refusal
