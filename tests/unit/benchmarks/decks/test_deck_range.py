"""Every deck of the range has its holes before the heads, a sensor for its weight, and a recipe."""

import json

import numpy as np
import pytest

from benchmarks.decks.chain import Figures, Outcome, Shipped
from benchmarks.decks.deck_range import DECKS, Deck, recipe_of, refusals, scenario_of, setting_of
from benchmarks.decks.table import document, markdown
from cellctl.geometry.pose import MM
from fakes.world.frames import from_written

SHIPPED_DECK = Deck(50.0, 1.0, 0.5)
LONGEST = Deck(500.0, 5.0, 2.0)
DRAWN = Deck(200.0, 2.0, 1.0, legs_mm=150.0)


@pytest.fixture(scope="module")
def shipped() -> Shipped:
    return Shipped.read()


def test_the_range_is_that_of_the_paper() -> None:
    assert len(DECKS) >= 8
    assert min(deck.mass_kg for deck in DECKS) == 10.0
    assert max(deck.mass_kg for deck in DECKS) == 500.0
    assert (min(deck.length_m for deck in DECKS), min(deck.width_m for deck in DECKS)) == (1.0, 0.5)
    assert (LONGEST.length_m, LONGEST.width_m) == (5.0, 2.0)
    assert LONGEST in DECKS


def test_the_deck_of_the_demonstration_is_the_shipped_one(shipped: Shipped) -> None:
    scenario = scenario_of(SHIPPED_DECK, shipped.scenario)
    assert scenario.parts.holes == shipped.scenario.parts.holes
    assert scenario.taught == shipped.scenario.taught
    assert scenario.force_sensors == shipped.scenario.force_sensors
    setting = setting_of(SHIPPED_DECK, shipped.setting)
    assert setting.recipe.mating == shipped.setting.recipe.mating
    for mine, theirs in zip(setting.deck.holes, shipped.setting.deck.holes, strict=True):
        np.testing.assert_allclose(mine.position_m, theirs.position_m, atol=1e-12)


@pytest.mark.parametrize("deck", [LONGEST, DRAWN, DECKS[0]], ids=lambda deck: deck.key)
def test_drawing_and_truth_agree_and_heads_stand_as_over_the_shipped_deck(
    shipped: Shipped, deck: Deck
) -> None:
    scenario, setting = scenario_of(deck, shipped.scenario), setting_of(deck, shipped.setting)
    true_mm = {hole.name: hole.position_mm for hole in scenario.parts.holes}
    for hole in setting.deck.holes:
        np.testing.assert_allclose(hole.position_m[:2] / MM, true_mm[hole.name], atol=1e-9)
    # The middle of its triangle lies before each head where that of the shipped deck does.
    for head, robot in (("head_1", "aux_1"), ("head_2", "aux_2")):
        places = []
        for one in (scenario, shipped.scenario):
            base_T_frame = from_written(one.parts.frame_mm_deg)
            flange = from_written(one.taught[robot]["measure"])
            names = one.parts.seen_by[head]
            holes = [hole.position_mm for hole in one.parts.holes if hole.name in names]
            middle_m = np.array([*np.mean(holes, axis=0), 0.0]) * MM
            places.append(flange.inv().apply(base_T_frame.apply(middle_m)))
        np.testing.assert_allclose(places[0], places[1], atol=0.1e-3)


def test_heavy_decks_get_a_sensor_that_carries_them(shipped: Shipped) -> None:
    (light,) = scenario_of(SHIPPED_DECK, shipped.scenario).force_sensors.values()
    (heavy,) = scenario_of(LONGEST, shipped.scenario).force_sensors.values()
    assert heavy.range_n * 0.8 == pytest.approx(650.0 * 9.81)
    assert heavy.noise_n / heavy.range_n == pytest.approx(light.noise_n / light.range_n)


def test_thresholds_keep_the_pins_and_check_says_what_does_not_fit(shipped: Shipped) -> None:
    assert refusals(SHIPPED_DECK, shipped.setting) == []
    about_z_deg = recipe_of(LONGEST, shipped.setting.recipe).pose_correction.thresholds_deg[2]
    assert np.radians(about_z_deg) * LONGEST.half_diagonal_m / MM < 0.1
    (refused,) = refusals(LONGEST, shipped.setting)
    assert "leave an edge" in refused
    assert "F524" in refused


def test_the_table_shows_the_worst_seed_and_every_reason() -> None:
    results = [
        Figures(DRAWN.key, 1, Outcome.GOOD, looks=2, lateral_mm=0.05, peak_n=36.0),
        Figures(DRAWN.key, 2, Outcome.REFUSED, "F528 too wide", looks=1),
        Figures(DRAWN.key, 3, Outcome.FALSE, looks=1, lateral_mm=0.25, peak_n=39.0),
    ]
    # A campaign that goes on has them from its file.
    results = [Figures.of(json.loads(json.dumps(one.row()))) for one in results]
    decks, refused = [DRAWN, LONGEST], {DRAWN.key: ["no"], LONGEST.key: []}
    text = markdown(decks, results, refused)
    assert document(decks, results, refused).endswith("1 of 2 decks are tried.\n\n" + text)
    row = text.splitlines()[2]
    assert "| 1 of 3 | 2 |" in row
    assert "| 0.250 |" in row
    assert "| 39.0 |" in row
    assert row.endswith("| refuses |")
    assert "- 200 kg, 2 × 1 m, 150 mm: F528 too wide" in text
    assert "**200kg-2x1m-150mm, seed 3: called good, is not**" in text
    assert "500 kg" not in text
