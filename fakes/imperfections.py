"""What is imperfect about the devices and parts of a fake cell: names, sizes, their sources.

A scenario says in ``[imperfections]`` how many times its realistic size each imperfection has. Each
draws from a random stream of its own, so switching one on leaves the draws of all others as they
were.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Imperfection:
    """One imperfection at its realistic size."""

    size: float
    """0 where the scenario file itself holds the sizes, under ``keys``."""
    unit: str
    acts: str
    """Where it acts, and how."""
    source: str
    """Where the size comes from; "assumed" where nobody has measured it."""
    keys: tuple[str, ...] = ()
    """Sizes in the scenario file that the scale multiplies, ``*`` for every device of a kind."""
    calibrated: bool = False
    """Belongs to the devices: another scale makes the calibrations of the cell wrong."""


CATALOGUE: Mapping[str, Imperfection] = {
    # -- arms ------------------------------------------------------------------------------------
    "links": Imperfection(
        0.0, "", "lengths and angles of every arm's links", "repeatable error of an industrial arm "
        "before its kinematic calibration, about 1 mm over the whole reach",
        keys=("robots.*.link_sigma_mm", "robots.*.link_sigma_deg", "robots.*.joint_sigma_deg"),
        calibrated=True,
    ),
    "repeatability": Imperfection(
        0.0, "", "pose of every arm at the end of a motion", "data sheets: ±0.05 mm and ±0.03 mm",
        keys=("robots.*.repeatability_mm", "robots.*.repeatability_deg", "robots.*.settling_mm",
              "robots.*.settling_deg"),
    ),
    "reducer_ripple": Imperfection(
        25.0, "arcsec", "joints of an arm that carries a force sensor: amplitude of the "
        "transmission error, which changes with the angle 40 times a turn",
        "data sheets of cycloidal (RV) reducers: at most 50 to 60 arcsec from peak to peak",
    ),
    "gravity_sag": Imperfection(
        15.0, "arcsec", "second and third joint of such an arm, stretched out level",
        "3 kN·m of payload on a reducer of 1 kN·m per arcmin; the controller corrects nine tenths",
    ),
    "base_drift": Imperfection(
        0.06, "mm", "base of every arm: offset since the calibrations, and as much in an hour",
        "a metre of steel, 5 K",
    ),
    "latency_jitter": Imperfection(
        10.0, "ms", "start of every motion: later by up to this much",
        "the job program polls its sockets once in an interpolation cycle of 4 to 12 ms",
    ),
    "stop_jitter": Imperfection(
        0.1, "ratio", "stop: the latency differs by up to this share, the brakes are weaker by up "
        "to it, anew each motion",
        "assumed; procedure 107 measures the spread on a real arm",
    ),
}  # fmt: skip


class UnknownImperfection(ValueError):
    """A name that the catalogue does not have, or a scale that is no number of at least 0."""


def parsed_scale(text: str) -> tuple[str, float]:
    """Name and scale from ``NAME=SCALE``; raises ``UnknownImperfection``."""
    name, _, written = text.partition("=")
    try:
        scale = float(written)
    except ValueError:
        raise UnknownImperfection(f"expected NAME=SCALE as in links=2, got {text!r}") from None
    check_scales({name: scale})
    return name, scale


def check_scales(scales: Mapping[str, float]) -> None:
    """Raise ``UnknownImperfection`` for the first that is not in the catalogue, or below 0."""
    for name, scale in scales.items():
        if name not in CATALOGUE:
            known = ", ".join(sorted(CATALOGUE))
            raise UnknownImperfection(f"there is no imperfection {name!r}; there are: {known}")
        if not isinstance(scale, int | float) or not 0 <= scale < float("inf"):
            raise UnknownImperfection(f"scale of {name!r} is {scale}, must be a number from 0")


def scale_written(written: Mapping[str, Any], scales: Mapping[str, float]) -> dict[str, Any]:
    """A scenario file's content with the sizes that it holds itself made so many times larger."""
    result = dict(written)
    for name, scale in scales.items():
        for key in CATALOGUE[name].keys:
            result = _multiplied(result, key.split("."), scale)
    return result


def _multiplied(table: Any, path: list[str], scale: float) -> Any:
    """A copy in which the value at ``path``, or each number of it, is multiplied."""
    if not path:
        return (
            [_multiplied(one, [], scale) for one in table]
            if isinstance(table, list)
            else (table * scale)
        )
    name, *rest = path
    names = list(table) if name == "*" else [name] if name in table else []
    return dict(table) | {one: _multiplied(table[one], rest, scale) for one in names}
