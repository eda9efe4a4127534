"""Slips of somebody who set up a cell for the first time, and what may be meant of them."""

from tests.unit.config.mistake import Mistake, Undecided, deck, drawn

_BOTH, _FRAME = ("deck.toml", "frame.toml"), ("frame.toml",)
_THICK = "deck_thickness_mm = 15.0"


def _of_two(old: str, new: str, said: str) -> Mistake:
    """A hole of the frame that differs from the deck's, which is named."""
    return Mistake("deck.toml", old, new, "recipes.0.deck_features", said, _FRAME)


PASSED_BEFORE = (
    deck(_THICK, "deck_thickness_mm = 14.0", "recipes.0.deck_thickness_mm", "on the fast travel"),
    deck(_THICK, "deck_thickness_mm = 15.05", "recipes.0.deck_thickness_mm", "take 0.048"),
    _of_two("diameter_mm = 6.0", "diameter_mm = 6.5", "hole P1 of features/frame.toml has 6.5"),
    _of_two("diameter_mm = 5.0", "diameter_mm = 3.0", "2.4 to 4.95 for one screw; hole P2"),
    drawn(_FRAME, "-80.0, -0.3]", "-80.0, 0.3]", "a rim lies in it or, under a chamfer, below"),
    drawn(("deck.toml",), "-80.0, -2.5]", "-80.0, 0.0]", "below a countersink, 1.4 mm or more"),
)

PASSES_WITH_REMARK = (
    Undecided(
        drawn(_BOTH, "diameter_mm = 6.0", "diameter_mm = 6.5", "(ISO 8734: 6 or 8)"),
        "a pin hole of no dowel: a pin may be made for it",
    ),
)
