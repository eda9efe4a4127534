"""A frame that does not stand where the deck is measured."""

from pathlib import Path

from cellctl.config import problems_before_commissioning
from tests.unit.config.test_mistakes import written


def test_a_frame_beside_the_deck_is_told_with_the_place_below_it(tmp_path: Path) -> None:
    old = "base_T_frame = [1900.0, 0.0, 400.0, 90.0"
    path = written(tmp_path, "deck.toml", old, old.replace("1900.0, 0.0", "1900.0, 300.0"))
    (issue,) = problems_before_commissioning(path)
    assert issue.key == "recipes.0.base_T_frame"
    assert issue.allowed.startswith("about [1900.0, 0.0, 400.0, 90.0, 0.0, 0.0]: below the deck")
