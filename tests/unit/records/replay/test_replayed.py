"""One number beside the other: the same, other, or known on one side only."""

import math

import pytest

from cellctl.records.replay.replayed import SOLVED, Replayed, compare_documents


@pytest.mark.parametrize(
    ("recorded", "computed", "identical"),
    [
        (1.0, 1.0 + 0.9e-6, True),
        (1.0, 1.0 + 1.1e-6, False),
        # A share of the number counts too, but a micrometre is not lost in metres.
        (5000.0, 5000.0 + 5e-6, True),
        (5000.0, 5000.0 + 7e-6, False),
    ],
)
def test_results_of_a_solver_may_differ_by_how_exactly_it_stops(
    recorded: float, computed: float, identical: bool
) -> None:
    (line,) = compare_documents("board", {"x_mm": recorded}, {"x_mm": computed})
    assert line.identical is identical
    assert line.difference == pytest.approx(computed - recorded, rel=1e-3)


def test_numbers_are_named_by_their_way_and_words_are_not_compared() -> None:
    recorded = {"method": "old", "views": [{"rms_px": 0.2, "used": True}, {"rms_px": 0.3}]}
    computed = {"method": "new", "views": ({"rms_px": 0.2, "used": False}, {"rms_px": 0.4})}
    lines = list(compare_documents("head", recorded, computed))
    assert [line.name for line in lines] == ["views.1.rms_px", "views.1.used", "views.2.rms_px"]
    assert [line.identical for line in lines] == [True, False, False]
    assert lines[2].difference == pytest.approx(0.1)


def test_what_one_side_does_not_have_is_unknown_there() -> None:
    recorded = {"held_out_px": None, "lost": 1.0, "nan": math.nan}
    computed = {"held_out_px": 0.5, "nan": math.nan}
    lines = {line.name: line for line in compare_documents("head", recorded, computed)}
    assert set(lines) == {"held_out_px", "lost"}
    assert (lines["held_out_px"].recorded, lines["lost"].computed) == (None, None)
    assert not any(line.identical for line in lines.values())


def test_unknown_on_both_sides_is_the_same() -> None:
    assert Replayed("head", "held_out", "px", None, None, SOLVED).identical
