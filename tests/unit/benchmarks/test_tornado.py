"""The tornado campaign: its cases, its ledger, and what it makes of outcomes."""

from pathlib import Path

import pytest

from benchmarks.tornado.cases import ALL, NONE, Case, cases
from benchmarks.tornado.chart import draw
from benchmarks.tornado.costs import costs
from benchmarks.tornado.ledger import Ledger
from benchmarks.tornado.outcome import Outcome, Verdict
from benchmarks.tornado.table import document, markdown
from fakes.imperfections import CATALOGUE, check_scales

GRIP = Case("grip_slip", 5.0, "cell", 1)


def outcome(case: Case, verdict: Verdict = Verdict.GOOD, **figures: float | None) -> Outcome:
    seen: dict[str, float | None] = {
        "lateral_mm": 0.02, "rotation_deg": 0.001, "seat_gap_mm": 0.01, "peak_n": 38.0,
        "final_n": 17.0,
    }  # fmt: skip
    text = "" if verdict is Verdict.GOOD else "F523"
    return Outcome(
        case, verdict, text, **(seen | figures), iterations=2, wall_s=60.0, software="cellctl 1"
    )


def test_every_imperfection_is_tried_at_every_size_beside_a_reference() -> None:
    wanted = list(cases((1.0, 2.0, 5.0), (1, 2)))
    assert len(set(wanted)) == len(wanted)
    names = {case.imperfection for case in wanted}
    assert names == {*CATALOGUE, NONE, ALL}
    assert {case.scale for case in wanted if case.imperfection == "burr"} == {1.0, 2.0, 5.0}
    # A case of once its size would be the reference.
    assert {case.scale for case in wanted if case.imperfection == "links"} == {2.0, 5.0}
    places = {case.place for case in wanted if case.imperfection == NONE}
    assert places == {"cell", "mating"}


def test_alone_means_that_no_other_is_on() -> None:
    scales = Case("burr", 2.0, "mating", 1).scales()
    check_scales(scales)
    assert {name for name, scale in scales.items() if scale} == {"burr"}
    assert not any(Case(NONE, 0.0, "cell", 1).scales().values())


def test_all_together_leaves_out_what_needs_other_calibrations() -> None:
    scales = Case(ALL, 2.0, "cell", 1).scales()
    assert scales["lens_misfit"] == 0.0
    assert "links" not in scales
    assert scales["reducer_ripple"] == scales["image_noise"] == 2.0


def test_an_interrupted_campaign_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "tornado.json"
    ledger = Ledger(path)
    done = outcome(GRIP, Verdict.NOTICED, lateral_mm=None)
    ledger.add(done)
    again = Ledger(path)
    assert again.outcomes == [done]
    assert again.has(GRIP)
    assert not again.has(Case("grip_slip", 2.0, "cell", 1))


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "tornado.json"
    path.write_text('[{"case": "1"}]')
    with pytest.raises(ValueError, match="holds no outcomes"):
        Ledger(path)


def test_costs_are_beside_the_reference_of_the_same_seed_and_the_dearest_comes_first() -> None:
    found = costs(
        [
            outcome(Case(NONE, 0.0, "cell", 1)),
            outcome(Case(NONE, 0.0, "cell", 2), lateral_mm=0.05),
            outcome(Case("glare", 1.0, "cell", 1), lateral_mm=0.03),
            outcome(GRIP, lateral_mm=0.06),
            outcome(Case("grip_slip", 5.0, "cell", 2), lateral_mm=0.07),
        ]
    )
    assert [cost.imperfection for cost in found] == ["grip_slip", "glare"]
    assert found[0].more["lateral_mm"] == pytest.approx(0.04)
    assert found[0].count(Verdict.GOOD) == 2


def test_a_part_that_was_never_seated_costs_no_offset(tmp_path: Path) -> None:
    found = costs(
        [
            outcome(Case(NONE, 0.0, "cell", 1)),
            outcome(GRIP, Verdict.NOTICED, seat_gap_mm=10.0),
            outcome(Case("burr", 1.0, "cell", 1), Verdict.NOT_NOTICED, lateral_mm=0.4),
        ]
    )
    assert [cost.imperfection for cost in found] == ["burr", "grip_slip"]
    assert found[1].more["lateral_mm"] is None
    lines = markdown(found).splitlines()
    assert lines[2].startswith("| burr | 1 × = 0.02 mm | cell | +0.380 | +0.0000 | +0.0 |")
    assert lines[3].endswith("| 2 | 0 | 1 | 0 |")
    draw(found, tmp_path / "tornado.png")
    assert (tmp_path / "tornado.png").stat().st_size > 10_000


def test_the_page_says_how_much_was_tried_and_why_parts_were_not_good() -> None:
    seen = [
        outcome(Case(NONE, 0.0, "cell", 1)),
        outcome(GRIP, Verdict.NOTICED),
        outcome(Case("glare", 2.0, "cell", 1)),
    ]
    page = document(costs(seen), seen, Path("pictures/tornado.png"))
    tried = len(list(cases((1.0, 2.0, 5.0), (1,))))
    assert f"\n3 of {tried} cases are tried; in none of them a part was called good" in page
    assert "](pictures/tornado.png)" in page
    assert "\n- grip_slip, 5 ×: F523\n" in page
    seen.append(outcome(Case("glare", 5.0, "cell", 1), Verdict.NOT_NOTICED))
    assert "in 1 of them a part" in document(costs(seen), seen, Path("tornado.png"))
