"""The scenario's appearance as options of the renderer."""

from pathlib import Path

import pytest

from fakes.render.look import options_of
from fakes.scenes.load import load

SCENARIO = Path(__file__).parents[4] / "config" / "deck.scenario.toml"


def test_options_follow_the_scenario() -> None:
    rendering = load(SCENARIO).rendering
    assert rendering is not None
    rendering = rendering.model_copy(
        update={
            "plate_level": 160.0,
            "hole_level": 20.0,
            "wall_visibility": 0.5,
            "countersink_levels": (0.4, 0.8),
            "read_noise_levels": 1.0,
            "electrons_per_level": 40.0,
            "scratches": 0,
        }
    )
    options = options_of(rendering)
    assert options.wall_grey == pytest.approx(90.0)
    assert options.cone_grey * (1 + options.cone_contrast) == pytest.approx(0.8 * 160)
    assert options.cone_grey * (1 - options.cone_contrast) == pytest.approx(0.4 * 160)
    assert options.noise_grey**2 == pytest.approx(1.0 + 160 / 40)
    assert options.shot_share == pytest.approx(0.8)
    assert options.scratches_per_m2 == 0
    assert options.white_grey == rendering.board_bright_level
