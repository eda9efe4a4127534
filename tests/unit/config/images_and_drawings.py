"""Mistakes at cameras, and in drawings that agree with each other."""

from tests.unit.config.mistake import Mistake, Undecided, drawn

_GIGE, _BOTH = "deck-gige.toml", ("deck.toml", "frame.toml")
_HEAD = "stereo_cameras.head_1"
_SETTINGS = f"[{_HEAD}.settings]"
_LAMP = """[digital_ios.lamps]
driver = "modbus-coupler"
settings = { host = "192.168.20.32", outputs = { ring = 0 } }
"""
_TWO_THREADS = drawn(_BOTH, 'kind = "pin"', 'kind = "thread"', "a screw in two threads presses")


def _producer(written: str) -> Mistake:
    old = 'producers = ["/opt/maker/lib/maker_gev.cti"]'
    new = f'producers = ["{written}"]'
    return Mistake(_GIGE, old, new, f"{_HEAD}.settings.producers", "which end in .cti")


def _light(settle_s: float) -> str:
    lit = f'light = {{ device = "lamps", output = "ring", settle_s = {settle_s} }}'
    return f"{lit}\n\n{_LAMP}\n{_SETTINGS}"


def _sizes(written: str) -> str:
    return f"auto_exposure = {{ hole_px = {written} }}\n\n{_SETTINGS}"


IMAGES_AND_DRAWINGS = (
    _producer("/opt/maker/lib"),
    _producer("/opt/maker/lib/libmaker_gev.so"),
    _TWO_THREADS,
    drawn(
        ("deck.toml",),
        "diameter_mm = 6.0",
        "diameter_mm = 3.1",
        "has 6: this is half of it, as the radius is in place of the diameter in features/deck",
    ),
    Mistake(
        "deck.toml",
        "diameter_mm = 5.0",
        "diameter_mm = 2.5",
        "recipes.0.deck_features",
        "has 2.5: this is twice as much, as the radius is in place of the diameter in features/fr",
        ("frame.toml",),
    ),
)
IMAGES_AND_DRAWINGS_PASS = (
    Undecided(
        Mistake(_GIGE, _SETTINGS, _light(8.0), f"{_HEAD}.light.settle_s", "each look waits"),
        "a lamp that is waited for very long: it may need that",
    ),
    Undecided(
        Mistake(_GIGE, _SETTINGS, _light(0.05), f"{_HEAD}.light.settle_s", ""),
        "a lamp that is waited for as usual",
    ),
    Undecided(
        Mistake(
            _GIGE,
            _SETTINGS,
            _sizes("[4.2, 6.0]"),
            f"{_HEAD}.auto_exposure.hole_px",
            "radii in pixels of the image, and not in mm",
        ),
        "holes of few pixels: the camera may be far away",
    ),
    Undecided(
        drawn(_BOTH, "diameter_mm = 5.0", "diameter_mm = 2.5", "4 times as wide as its bore"),
        "a countersink that is far wider than its bore: a screw may have such a head",
    ),
)
