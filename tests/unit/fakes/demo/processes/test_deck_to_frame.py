"""The demonstration holds a part against the truth by every limit that a good part has."""

from copy import deepcopy
from typing import Any

import pytest

from fakes.demo.demo import Evidence
from fakes.demo.processes.deck_to_frame import DeckToFrameDemo

TRUTH: dict[str, Any] = {
    "pins": {name: {"offset_mm": 0.03, "gauge_mm": 5.97} for name in ("P1", "P5")},
    "frame_T_deck_mm_deg": [0.01, -0.01, 15.02, 0.001, -0.001, 0.002],
    "deck_thickness_mm": 15.01,
    "peak_contact_force_n": 38.0,
    "contact_force_n": 17.0,
}
RECORD: dict[str, Any] = {
    "figures": [
        {"key": "peak_force", "value": 42.0, "verdict": "pass"},
        {"key": "hold_force", "value": 37.0, "verdict": "pass"},
        {"key": "approach.speed", "value": 0.3, "verdict": None},
    ],
    "passes": [{"converged": True, "components": [{"value": 0.01}]}],
}
GOOD = {"result": "good", "run": 1}


def judged(truth: dict[str, Any] | None = None, record: dict[str, Any] | None = None) -> list[str]:
    """Names of what is beyond its limit; the verdict must agree with them."""
    changed = deepcopy(TRUTH) | (truth or {})
    judgement = DeckToFrameDemo().judge(Evidence(GOOD, changed, deepcopy(RECORD) | (record or {})))
    beyond = list(judgement.figures["beyond"])
    assert judgement.passed == (not beyond)
    return beyond


def test_a_good_part_passes() -> None:
    assert judged() == []


def test_what_the_cell_calls_bad_is_not_good() -> None:
    evidence = Evidence({"result": "bad"}, deepcopy(TRUTH), deepcopy(RECORD))
    assert not DeckToFrameDemo().judge(evidence).passed


@pytest.mark.parametrize("gap_mm", [3.0, 0.15, -0.15])
def test_a_gap_under_the_seated_deck_is_bad(gap_mm: float) -> None:
    pose = [0.01, -0.01, 15.01 + gap_mm, 0.001, -0.001, 0.002]
    assert judged({"frame_T_deck_mm_deg": pose}) == ["true seat gap, mm"]


@pytest.mark.parametrize(
    ("angles_deg", "name"),
    [
        ([0.015, 0.0, 0.0], "true rotation about y or z, deg"),
        ([0.0, -0.015, 0.0], "true rotation about y or z, deg"),
        ([0.0, 0.0, -0.03], "true rotation about x, deg"),
    ],
)
def test_a_turned_deck_is_bad(angles_deg: list[float], name: str) -> None:
    assert judged({"frame_T_deck_mm_deg": [0.01, -0.01, 15.01, *angles_deg]}) == [name]


def test_about_its_long_axis_a_deck_may_be_off_by_more() -> None:
    assert judged({"frame_T_deck_mm_deg": [0.01, -0.01, 15.01, 0.0, 0.0, 0.015]}) == []


def test_the_last_look_is_held_against_the_truth_in_its_own_sigmas() -> None:
    # Target minus measured; the true deck is 0.02 mm too high and turned by 0.002° about z.
    error, sigma = [0.0, 0.0, -0.03, 0.0, 0.0, -0.002], [0.01, 0.01, 0.005, 0.001, 0.001, 0.0005]
    seen = [
        {"key": f"seated_{what}.{axis}", "value": value, "verdict": None}
        for what, values in (("error", error), ("sigma", sigma))
        for axis, value in zip(("x", "y", "z", "rx", "ry", "rz"), values, strict=True)
    ]
    truth = TRUTH | {"frame_T_deck_mm_deg": [0.01, 0.0, 15.02, 0.002, -0.001, 0.0]}
    record = RECORD | {"figures": [*RECORD["figures"], *seen]}
    evidence = Evidence(GOOD, truth, record, {"deck_thickness_mm": 15.0})
    found = DeckToFrameDemo().judge(evidence).figures["seat_normalised"]
    assert found == pytest.approx([1.0, 0.0, -2.0, 0.0, -1.0, 0.0])


def test_a_run_without_a_last_look_has_no_normalised_errors() -> None:
    evidence = Evidence(GOOD, TRUTH, RECORD)
    assert DeckToFrameDemo().judge(evidence).figures["seat_normalised"] is None


@pytest.mark.parametrize(
    ("truth", "name"),
    [
        ({"peak_contact_force_n": 51.0}, "peak contact force, true, N"),
        ({"contact_force_n": 0.0}, "force left for fastening, true, N"),
        ({"pins": {"P1": {"offset_mm": 0.2, "gauge_mm": 5.9}}}, "true offset at the pin holes, mm"),
        (
            {"pins": {"P1": {"offset_mm": 0.1, "gauge_mm": 5.79}}},
            "smallest of the largest plug gauges, mm",
        ),
    ],
)
def test_every_true_figure_has_its_limit(truth: dict[str, Any], name: str) -> None:
    assert judged(truth) == [name]


def test_a_force_that_was_not_held_is_bad() -> None:
    figures = [{"key": "peak_force", "value": 42.0, "verdict": "pass"}]
    held = [*figures, {"key": "hold_force", "value": 30.0, "verdict": "pass"}]
    assert judged(record={"figures": held}) == ["force held, sensed, N"]
    assert judged(record={"figures": figures}) == ["force held, sensed, N"], "unknown is not good"


def test_a_figure_of_the_record_that_failed_is_bad() -> None:
    failed = {"key": "seat_gap", "value": 0.2, "verdict": "fail"}
    assert judged(record={"figures": [*RECORD["figures"], failed]}) == ["seat_gap of the record"]
    repeated = {"key": "seat_gap", "value": 0.0, "verdict": "pass"}
    figures = [*RECORD["figures"], failed, repeated]
    assert judged(record={"figures": figures}) == [], "a further attempt replaces the earlier one"


def test_a_loop_that_did_not_converge_is_bad() -> None:
    passes = [{"converged": False, "components": [{"value": 0.2}]}]
    assert judged(record={"passes": passes}) == ["convergence of the loop"]


def test_the_errors_of_every_look_are_among_the_figures() -> None:
    looks = [
        {"converged": False, "components": [{"value": 0.3}, {"value": -0.02}]},
        {"converged": True, "components": [{"value": 0.01}, {"value": 0.001}]},
    ]
    evidence = Evidence(GOOD, deepcopy(TRUTH), deepcopy(RECORD) | {"passes": looks})
    figures = DeckToFrameDemo().judge(evidence).figures
    assert figures["errors_mm_deg"] == [[0.3, -0.02], [0.01, 0.001]]
