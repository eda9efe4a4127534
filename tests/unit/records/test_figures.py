"""Figures: limits judge them, documents of plain data are taken apart into them."""

import math

import pytest

from cellctl.records.entries import Verdict
from cellctl.records.figures import KNOWN_TO, Limit, figure, split_document, verdicts


@pytest.mark.parametrize(
    ("limit", "value", "verdict"),
    [
        (Limit(), 1.0, None),
        (Limit(), None, None),
        (Limit(upper=50.0), 50.0, Verdict.PASS),
        (Limit(upper=50.0), 50.001, Verdict.FAIL),
        (Limit(lower=5.8), 5.8, Verdict.PASS),
        (Limit(lower=5.8), 5.79, Verdict.FAIL),
        (Limit(35.0, 45.0), 40.0, Verdict.PASS),
        (Limit(35.0, 45.0), 34.0, Verdict.FAIL),
        (Limit(35.0, 45.0), 46.0, Verdict.FAIL),
        (Limit(upper=50.0), None, Verdict.FAIL),
        (Limit(upper=50.0), math.nan, Verdict.FAIL),
        (Limit(lower=0.0), math.inf, Verdict.FAIL),
    ],
)
def test_a_limit_judges(limit: Limit, value: float | None, verdict: Verdict | None) -> None:
    found = figure("peak", value, "N", limit=limit)
    assert found.verdict is verdict
    assert (found.lower, found.upper) == (limit.lower, limit.upper)
    assert found.value is None or math.isfinite(found.value)


@pytest.mark.parametrize(
    ("value", "known_to", "said"),
    [
        (0.002, 0.003, "within threshold, as measured"),
        (0.004, 0.003, "within threshold, as measured"),
        (0.007, 0.003, "fail"),
        (0.004, None, "pass"),
    ],
)
def test_what_ends_a_correction_is_compared_and_decides_nothing_about_the_part(
    value: float, known_to: float | None, said: str
) -> None:
    found = [figure("angle", value, "°", limit=Limit(upper=0.006)), figure("speed", 1.0, "mm/s")]
    if known_to is not None:
        found.append(figure(f"angle{KNOWN_TO}", known_to, "°"))
    assert verdicts({one.key: one for one in found}) == {"angle": said}


def test_the_key_says_what_it_is_where_there_is_no_label() -> None:
    assert figure("approach.stop_latency", 0.3, "s").label == "approach: stop latency"
    assert figure("peak", 0.3, "N", label="Peak force").label == "Peak force"


def test_a_document_is_taken_apart() -> None:
    document = {
        "outcome": "seated",
        "approach": {"formula": "F = k v", "speed_mm_s": 0.25},
        "pin_offsets_mm": {"P1": 0.01, "P5": 0.3},
        "seated_error_mm_deg": [1.0, 2.0, 3.0, 0.1, 0.2, 0.3],
        "hold_wrench": [1.0, 2.0],
        "stiffness_n_per_mm": None,
        "reason": None,
        "steps": 3,
        "dry": False,
    }
    figures, rest = split_document(document, {"pin_offsets.P5": Limit(upper=0.2)})
    assert {entry.key: (entry.value, entry.unit) for entry in figures} == {
        "approach.speed": (0.25, "mm/s"),
        "pin_offsets.P1": (0.01, "mm"),
        "pin_offsets.P5": (0.3, "mm"),
        "seated_error.x": (1.0, "mm"),
        "seated_error.y": (2.0, "mm"),
        "seated_error.z": (3.0, "mm"),
        "seated_error.rx": (0.1, "°"),
        "seated_error.ry": (0.2, "°"),
        "seated_error.rz": (0.3, "°"),
        "stiffness": (None, "N/mm"),
        "steps": (3.0, ""),
    }
    assert [entry.key for entry in figures if entry.verdict is Verdict.FAIL] == ["pin_offsets.P5"]
    assert rest == {
        "outcome": "seated",
        "approach": {"formula": "F = k v"},
        "hold_wrench": [1.0, 2.0],
        "reason": None,
        "dry": False,
    }
