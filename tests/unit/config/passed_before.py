"""Slips of somebody who set up a cell for the first time, and what may be meant of them."""

from tests.unit.config.mistake import Mistake, Undecided, deck, drawn

_BOTH, _FRAME = ("deck.toml", "frame.toml"), ("frame.toml",)
_THICK = "deck_thickness_mm = 15.0"


def _of_two(old: str, new: str, said: str) -> Mistake:
    """A hole of the frame that differs from the deck's, which is named."""
    return Mistake("deck.toml", old, new, "recipes.0.deck_features", said, _FRAME)


_MODULE = "module_mass_kg = 0.25"
_MASS, _CORRECTION = "recipes.0.load.mass_kg", "recipes.0.pose_correction"
_GAP = "recipes.0.gap_zero_mm"
_MOST = "max_iterations = 10"

PASSED_BEFORE = (
    Mistake("antenna.toml", _MODULE, f"{_MODULE}\ngap_zero_mm = 0.4", _GAP, "at most 0.078"),
    Mistake("antenna.toml", _MODULE, f"{_MODULE}\ngap_zero_mm = -0.4", _GAP, "at least -0.078"),
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
    Undecided(
        Mistake("insertion-pin.toml", "kg = 1.1", "kg = 0.11", _MASS, "(170 mm) weighs 0.23"),
        "a light load: nothing weighs it, and light tools exist",
    ),
    Undecided(
        Mistake("insertion-pin.toml", "kg = 1.1", "kg = 0.0011", _MASS, "depth_mm alone 0.0027"),
        "a load in tonnes: nothing weighs it",
    ),
    Undecided(
        deck(_MOST, "max_iterations = 1", f"{_CORRECTION}.max_iterations", "given up after one"),
        "one correction: a trial",
    ),
    Undecided(
        deck(
            _MOST,
            f"{_MOST}\nmax_correction_deg = 10.0",
            f"{_CORRECTION}.max_correction_deg",
            "differ by at most 6",
        ),
        "a limit that stops nothing: the stations are refused before",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "board_distance_mm = 250.0",
            "board_distance_mm = 350.0",
            "processes.antenna-module.board_distance_mm",
            "by which it is focused",
        ),
        "a board that is farther than all looks: a lens may be stopped down",
    ),
)
