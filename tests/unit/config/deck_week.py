"""Mistakes of a week at the cell of decks: copied sections, drawings that nearly agree."""

from pathlib import Path

from tests.unit.config.mistake import Undecided, deck, drawn

_TEXT = (Path(__file__).parents[3] / "config" / "deck.toml").read_text()
_BACK = 'start = "deck_measure"\nend = "home"'
_THERE = 'start = "home"\nend = "deck_measure"'
_WAY = f"[[robots.main.ways]]\n{_BACK}\nvia_deg = [[0.0, -90.0, 120.0, 0.0, 84.0, 90.0]]"
_PLATE = '\nserial_number = "4711"'
_BOUND = "max_joint_speed_percent = 50"
_MAIN = "robots.main.settings"


def _plates(first: str, second: str) -> tuple[str, str]:
    """A piece of the cell file from one key to another, and the same with one plate at both."""
    piece = _TEXT[_TEXT.index(first) : _TEXT.index(second) + len(second)]
    return piece, piece.replace(first, first + _PLATE).replace(second, second + _PLATE)


_HEADS = _plates('carried_by = "aux_1"', 'carried_by = "aux_2"')

DECK_WEEK = (
    deck(_BACK, _THERE, "robots.main.ways.1.start", "is it the way back, from 'deck_measure'?"),
    deck(_THERE, 'start = "home"\nend = "home"', "robots.main.ways.0.end", "another pose"),
    deck(*_HEADS, "stereo_cameras.head_2.serial_number", "two devices, two plates"),
    drawn(("deck.toml",), "[480.0, 180.0, 0.0]", "[480.1, 180.0, 0.0]", "one pin goes through"),
)
DECK_WEEK_PASSES = (
    Undecided(
        deck(
            _WAY,
            _WAY.replace("84.0", "94.0"),
            "robots.main.ways.1",
            "the way from 'home' to 'deck_measure' leads over other joints",
        ),
        "another way back: both may be free, which the model of the cell tells",
    ),
    Undecided(
        deck(_WAY, "", "robots.main.ways.0", "back from 'deck_measure' to 'home' the arm goes"),
        "a way in one direction: the straight one back may be free",
    ),
    Undecided(
        deck(
            _BOUND,
            f"{_BOUND}\narrival_tolerance_mm = 5.0",
            f"{_MAIN}.arrival_tolerance_mm",
            "counts as arrived",
        ),
        "a wide tolerance of arrival: what is measured there counts",
    ),
    Undecided(
        drawn(
            ("deck.toml", "frame.toml"),
            'head_1 = ["P1", "P2", "P3"]',
            'head_1 = ["P1", "P2"]',
            "fewer than three holes",
        ),
        "two holes of a head: the pose follows from those of both",
    ),
)
