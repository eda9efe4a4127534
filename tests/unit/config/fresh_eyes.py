"""Slips that somebody tried who had read the documents alone."""

from tests.unit.config.mistake import Mistake, Undecided

_MODULE = "module_mass_kg = 0.25"


def _module(key: str, value: float, said: str) -> Mistake:
    """A further key of the antenna recipe."""
    return Mistake("antenna.toml", _MODULE, f"{_MODULE}\n{key} = {value}", f"recipes.0.{key}", said)


def _insertion(key: str, value: float, said: str) -> Mistake:
    """A further key of its insertion, whose table the shipped file does not have."""
    table = f"[recipes.insertion]\n{key} = {value}\n\n"
    before = "[recipes.base_T_tray_plug]"
    return Mistake("antenna.toml", before, f"{table}{before}", f"recipes.0.insertion.{key}", said)


ANTENNA = (
    _module("seated_limit_deg", 4.9, "at most 2.557: more moves the contact that is 4.48 mm"),
    _module("gap_limit_mm", 0.9, "at most 0.5: 0.25 of the 2 mm from spring_depth_mm"),
    _module("gap_limit_mm", 0.45, "at most 0.35"),
    _insertion("seat_tolerance_mm", 1.0, "at most 0.5: 0.25 of the 2 mm"),
    _insertion("pull_n", 19.0, "at most 5: the least force_n of the socket's drawing"),
)
FRESH_EYES = ANTENNA


def _samples(file: str, unit: str, said: str) -> Undecided:
    rate = "rate_hz = "
    key = "force_sensors.force.settings.unit"
    slip = Mistake(file, rate, f'unit = "{unit}", {rate}', key, said)
    return Undecided(slip, f"unit {unit} of the samples: the driver makes newtons of them")


SENSOR_PASSES = (
    _samples("deck.toml", "C", "hung on the sensor, reads as what it weighs"),
    _samples("antenna.toml", "M", "no device has proven yet"),
)

ANTENNA_PASSES = (
    Undecided(
        _module("mass_tolerance_ratio", 0.5, "modules of 0.125 to 0.375 kg pass for this one"),
        "a wide tolerance of the mass: a hose may pull while it is weighed",
    ),
    Undecided(
        _insertion("pull_travel_mm", 1.0, "drawn farther than the 0.5 mm"),
        "a long travel of the pull: arm and fingers may give way",
    ),
    Undecided(_insertion("pull_n", 4.9, ""), "a pull that the weakest good plug just holds"),
    Undecided(_module("seated_limit_deg", 2.5, ""), "a turn at which all pins are in their holes"),
    Undecided(_insertion("seat_tolerance_mm", 0.4, ""), "an arm whose heights are less certain"),
)
FRESH_EYES_PASSES = ANTENNA_PASSES + SENSOR_PASSES
