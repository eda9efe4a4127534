"""Mistakes of somebody who set up the cells that plug a module and that insert by touch."""

from collections.abc import Iterator

from tests.unit.config.mistake import Mistake

_ANTENNA = "antenna.toml"
_TOUCHING = (_ANTENNA, "insertion-connector.toml")
_RANGE = "force_sensors.force.settings.range"
_SIX = "range = [200.0, 200.0, 200.0, 10.0, 10.0, 10.0]"


def _sensors() -> Iterator[Mistake]:
    moments = _SIX.replace("10.0", "10000.0")
    for file in _TOUCHING:
        yield Mistake(file, _SIX, moments, _RANGE, "or were the moments in N·mm?")
        for limit, least in (("190.0", "at least 211 N"), ("199.0", "at least 221 N")):
            yield Mistake(
                file,
                "free_force_n = 60.0",
                f"free_force_n = {limit}",
                _RANGE,
                least,
                at_the_other=True,
            )
        yield Mistake(
            file,
            "free_moment_n_m = 8.0",
            "free_moment_n_m = 9.9",
            _RANGE,
            "at least 11 N·m",
            at_the_other=True,
        )
    tenfold = "range = [2000.0, 2000.0, 2000.0, 100.0, 100.0, 100.0]"
    yield Mistake(_ANTENNA, _SIX, tenfold, _RANGE, "forces of at most 1000 N")


TOUCHING_CELLS = (*_sensors(),)
