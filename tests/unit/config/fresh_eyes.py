"""Slips that somebody tried who had read the documents alone."""

from tests.unit.config.mistake import Mistake, Undecided, deck

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
_TARGET, _MATING = "target_force_n = 35.0", "recipes.0.mating"
FORCES_PASS = (
    Undecided(
        deck(
            _TARGET,
            f"{_TARGET}\nrelease_force_n = 34.5",
            f"{_MATING}.release_force_n",
            "up to 39.5 N may be left for fastening",
        ),
        "fastened under nearly all of the force: a seal may need it",
    ),
    Undecided(
        deck(
            _TARGET,
            f"{_TARGET}\ntouch_force_n = 34.0",
            f"{_MATING}.touch_force_n",
            "less than half of it, 17 N, is taken for drift",
        ),
        "a touch that is noticed late: the sensor may be noisy",
    ),
    Undecided(
        deck(_TARGET, f"{_TARGET}\nrelease_force_n = 16.0\ntouch_force_n = 14.0", _MATING, ""),
        "touch and rest at the greatest usual share of the target",
    ),
)


def _network(old: str, new: str, key: str, said: str, reason: str) -> Undecided:
    return Undecided(Mistake("cell.toml", old, new, key, said), reason)


_AUX, _PLC = '"192.168.20.12"', '["192.168.10.2"]'
_CALLS = "robots.main, robots.aux_2 may call here, too"
NETWORKS_PASS = (
    _network(
        _AUX,
        '"192.168.0.0/16"',
        "robots.aux_1.settings.robot_address",
        _CALLS,
        "a network that holds other controllers: addresses may change",
    ),
    _network(_AUX, '"192.168.20.12/32"', "robots.aux_1", "", "one address, written as a network"),
    _network(
        _PLC,
        '["0.0.0.0/0"]',
        "plc.allowed_clients",
        "one of 4.29e+09 addresses may start and stop the cell",
        "every client: the network may be a closed one",
    ),
    _network(_PLC, '["192.168.10.0/24"]', "plc", "", "clients of the network of one machine"),
)
FRESH_EYES_PASSES = ANTENNA_PASSES + SENSOR_PASSES + FORCES_PASS + NETWORKS_PASS
