"""Holds the forces and stiffnesses of a recipe against the load that hangs on the arm."""

from collections.abc import Iterator
from math import floor, log10

from cellctl.config.cell import CellConfig
from cellctl.config.checks.plausible.loads import G_M_S2
from cellctl.config.driver_settings import measuring_range
from cellctl.config.issue import ConfigIssue
from cellctl.force.gravity.acceptance import PayloadLimits
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.mating.settings import FAST_LIMIT_N
from cellctl.processes.deck_to_frame.recipe import DeckRecipe, Mating
from cellctl.processes.deck_to_frame.roles import FORCE, MAIN

_MOST_SAG_MM = 10.0
"""Greatest sag of an arm under its load. It is that of a lowest natural frequency of 5 Hz, sqrt(g /
sag) / 2 pi, which every industrial arm exceeds with its rated load."""
_SWINGS_TO = 2.0
"""Times the force of a steady acceleration: a load on a spring that is suddenly accelerated."""
_MOST_LEFT = 0.2
"""Greatest share of the weight that gravity compensation may leave; 4 % is usual."""
_WEIGHED_TO = PayloadLimits().mass_ratio + PayloadLimits().crosstalk_ratio
"""Share of the mass by which a weighing that is accepted may be off."""
_OVERSHOOT = 1.05
"""Factor by which impact and braking increase a force that grows until the arm stands: 5 % at most
in simulated contacts at 1 to 5 mm/s with latencies of 100 and 250 ms."""
_ALUMINIUM_KG_M3 = 2700.0
"""Few decks are as heavy: most are panels with a core of honeycomb."""
_MOST_RANGE = 10.0
"""Range of a sensor over the weight on it. Noise and cross-talk are shares of the range: beyond
this, 1 % of it is a tenth of the weight."""


def load_issues(cell: CellConfig, recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """Stiffnesses that are no upper bound, and a plausible force that any payload meets."""
    robot = recipe.device(MAIN)
    load, mating = cell.robots[robot].load, recipe.mating
    if load is None:
        return
    weight_n = load.mass_kg * G_M_S2
    least_n_per_mm = weight_n / _MOST_SAG_MM
    stiffnesses = {"stiffness_n_per_mm": mating.stiffness_n_per_mm}
    if mating.pins is not None and mating.pins.lateral_stiffness_n_per_mm is not None:
        stiffnesses["pins.lateral_stiffness_n_per_mm"] = mating.pins.lateral_stiffness_n_per_mm
    for name, stiffness in stiffnesses.items():
        if stiffness < least_n_per_mm:
            allowed = (
                f"an upper bound, at least {least_n_per_mm:.0f}: under its load of "
                f"{load.mass_kg:g} kg robots.{robot} would sag by {weight_n / stiffness:.0f} mm"
            )
            yield ConfigIssue(f"{key}.mating.{name}", f"{stiffness:g}", allowed)
    weighed_kg = load.mass_kg - load.not_weighed_kg
    most_mm_s2 = FAST_LIMIT_N / _SWINGS_TO / weighed_kg * 1e3
    if mating.acceleration_mm_s2 > most_mm_s2:
        allowed = (
            f"at most {most_mm_s2:.0f}: {weighed_kg:.0f} kg that begin to move swing to twice the "
            f"force of their acceleration, and {FAST_LIMIT_N:g} N end the fast travel as a contact "
            "that came too early (F522)"
        )
        value = f"{mating.acceleration_mm_s2:g}"
        yield ConfigIssue(f"{key}.mating.acceleration_mm_s2", value, allowed)
    yield from _fast_travel(cell, recipe, weighed_kg, key)
    if mating.max_untared_force_n > _MOST_LEFT * weight_n:
        left_n = mating.max_untared_force_n
        allowed = (
            f"at least {left_n / _MOST_LEFT / G_M_S2:.0f} kg with {key}.mating.max_untared_force_n "
            f"= {left_n:g}, which is {left_n / weight_n:.0%} of this weight and 4 % of the usual; "
            f"or that force at most {_MOST_LEFT * weight_n:.0f} N"
        )
        yield ConfigIssue(f"robots.{robot}.load.mass_kg", f"{load.mass_kg:g}", allowed)


def _fast_travel(
    cell: CellConfig, recipe: DeckRecipe, weighed_kg: float, key: str
) -> Iterator[ConfigIssue]:
    """A fast travel that meets what nothing has measured with more than parts or sensor carry.

    A deck that is thicker than stated meets its frame there. The guard sees it at its limit, and
    the force grows by stiffness times speed until the arm stands (docs/mating.md).
    """
    mating = recipe.mating
    carriers: dict[str, float] = {}
    # A sensor too weak for the weight itself is named by its own check.
    if (left_n := _sensor_left_n(cell, recipe, weighed_kg)) > FAST_LIMIT_N:
        carriers["the sensor carries {:.0f} N beside the weight"] = left_n
    if mating.unexpected_force_n is not None:
        carriers["unexpected_force_n is {:.0f}"] = mating.unexpected_force_n
    if not carriers:
        return
    words, carried_n = min(carriers.items(), key=lambda item: item[1])
    if unexpected_n(mating) <= carried_n:
        return
    grows_n_per_mm_s = _OVERSHOOT * mating.stiffness_n_per_mm * mating.stop_latency_ms / 1e3
    most_mm_s = _rounded_down((carried_n - FAST_LIMIT_N) / grows_n_per_mm_s)
    allowed = (
        f"at most {most_mm_s:g}: a deck that is thicker than stated meets its frame on the fast "
        f"travel, and at this speed presses {unexpected_n(mating):.0f} N before the arm stands "
        f"(by stiffness_n_per_mm and stop_latency_ms); {words.format(carried_n)}"
    )
    yield ConfigIssue(f"{key}.mating.fast_speed_mm_s", f"{mating.fast_speed_mm_s:g}", allowed)


def _sensor_left_n(cell: CellConfig, recipe: DeckRecipe, weighed_kg: float) -> float:
    """What the sensor carries beside the weight; 0 where its range is not known."""
    measuring = measuring_range(cell.force_sensors[recipe.device(FORCE)])
    return min(measuring[:3]) - weighed_kg * G_M_S2 if measuring else 0.0


def _rounded_down(speed_mm_s: float) -> float:
    """The speed rounded down to two digits: what a finding names has to pass."""
    digit = 10.0 ** (floor(log10(speed_mm_s)) - 1)
    return floor(speed_mm_s / digit) * digit


def unexpected_n(mating: Mating) -> float:
    """Force that the fast travel presses with until the arm stands, N; an upper bound.

    It stops at ``FAST_LIMIT_N``, and until then the force grows by stiffness times speed.
    """
    way_mm = mating.fast_speed_mm_s * mating.stop_latency_ms / 1e3
    return FAST_LIMIT_N + _OVERSHOOT * mating.stiffness_n_per_mm * way_mm


def _light_deck(recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """A force below which an empty gripper is not told from one with such a deck (F530)."""
    length_mm, width_mm = recipe.face_mm
    solid_kg = length_mm * width_mm * recipe.deck_thickness_mm * MM**3 * _ALUMINIUM_KG_M3
    hidden_n = recipe.mating.max_untared_force_n
    if solid_kg * G_M_S2 < hidden_n:
        said = (
            f"hides {hidden_n / G_M_S2:.1f} kg: a deck of this face and thickness weighs "
            f"{solid_kg:.1f} kg if it is solid aluminium and carries nothing, and an empty gripper "
            "is then taken for one that still holds it (F530). Write about 4 % of the weight on "
            "the sensor, if the deck weighs more than that"
        )
        yield ConfigIssue(f"{key}.mating.max_untared_force_n", f"{hidden_n:g}", said)


def load_remarks(cell: CellConfig, recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """Forces that nothing bounds; a load that nothing is compared with, hardly compared, or weighed
    by too large a sensor. ``key`` is the path of the recipe."""
    robot, force = recipe.device(MAIN), recipe.device(FORCE)
    if recipe.mating.unexpected_force_n is None:
        said = (
            "nothing says what deck, frame and gripper take: a deck that is thicker than stated is "
            f"pressed with up to {unexpected_n(recipe.mating):.0f} N at fast_speed_mm_s"
        )
        yield ConfigIssue(f"{key}.mating.unexpected_force_n", "(missing)", said)
    yield from _light_deck(recipe, key)
    load = cell.robots[robot].load
    if load is None:
        said = (
            "without it nothing is compared with what procedure 106 weighs: a controller that "
            "reckons with another load moves another arm"
        )
        yield ConfigIssue(f"robots.{robot}.load", "(missing)", said)
        return
    left_n = _sensor_left_n(cell, recipe, load.mass_kg - load.not_weighed_kg)
    carried_n = recipe.mating.unexpected_force_n
    if carried_n is not None and 0.0 < left_n < carried_n:
        said = f"never acts: the sensor carries {left_n:.0f} N beside the weight"
        yield ConfigIssue(f"{key}.mating.unexpected_force_n", f"{carried_n:g}", said)
    if load.tolerance_kg > _WEIGHED_TO * load.mass_kg:
        said = (
            f"more than {_WEIGHED_TO * load.mass_kg:g} kg, {_WEIGHED_TO:.0%} of the mass, by which "
            "a weighing that is accepted may be off: another load would pass for this one"
        )
        yield ConfigIssue(f"robots.{robot}.load.tolerance_kg", f"{load.tolerance_kg:g}", said)
    measuring = measuring_range(cell.force_sensors[force])
    weight_n = (load.mass_kg - load.not_weighed_kg) * G_M_S2
    if measuring:
        least_n = min(measuring[:3])
        if least_n > _MOST_RANGE * weight_n:
            said = (
                f"{least_n:g} N for a weight of {weight_n:.0f} N: right if the sensor is so large; "
                "with a range that it does not have, a clipped force is taken for a true one"
            )
            yield ConfigIssue(f"force_sensors.{force}.settings.range", str(measuring), said)
