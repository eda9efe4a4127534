"""Figures with which a cell that passed its check could never say of a part that it is good."""

from tests.unit.config.mistake import Mistake, Undecided

_PIN, _PLUG = "insertion-pin.toml", "insertion-connector.toml"
_FIT = "recipes.0.fit"


def _friction(value: float, said: str) -> Mistake:
    new = f"friction = {value}"
    return Mistake(_PIN, "friction = 0.2", new, f"{_FIT}.friction", said)


FRESH_CELLS = (
    _friction(0.8, "at most 0.7408, or insertion_n = 30 is too low: the verdict pushes sideways"),
    _friction(0.99, "the verdict pushes sideways with 796 N"),
    Mistake(
        _PLUG,
        "search_n = 10.0",
        "search_n = 40.0",
        "recipes.0.forces.search_n",
        "at most 36, or grip_n = 150 is too low: 100 N, up to which the guard lets a search press",
    ),
    Mistake(
        _PIN,
        "clearance_mm = 0.05",
        "clearance_mm = 4.9",
        f"{_FIT}.clearance_mm",
        "half of peg_radius_mm",
    ),
)


def _turned(file: str) -> Undecided:
    key = "force_sensors.force.flange_T_sensor"
    old = "flange_T_sensor = [0.0, 0.0, 30.0, 0.0, 0.0, 0.0]"
    new = old.replace("0.0]", "180.0]")
    slip = Mistake(file, old, new, key, "a press is felt as a pull")
    return Undecided(slip, f"the sensor of {file} the other way round")


FRESH_CELLS_PASS = (
    Undecided(_friction(0.6, "pushes the part sideways with 16 N"), "a rough pair of materials"),
    _turned(_PLUG),
    _turned("antenna.toml"),
    Undecided(
        Mistake(
            _PIN,
            'host = "127.0.0.1"\nport = 5',
            'host = "127.0.0.1"\nallowed_clients = ["0.0.0.0/0"]\nport = 5',
            "plc.allowed_clients",
            "may start and stop the cell",
        ),
        "a fake cell that everybody may start",
    ),
    Undecided(
        Mistake(
            _PIN,
            'transport = "tcp", host = "127.0.0.1"',
            'transport = "tcp", host = "8.8.8.8"',
            "force_sensors.force.settings.host",
            "an address of the internet",
        ),
        "a fake sensor somewhere in the internet",
    ),
)
