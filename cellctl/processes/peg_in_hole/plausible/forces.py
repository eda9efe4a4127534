"""Holds the forces of a recipe against each other, the part, and what the sensor can say."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.checks.places.sensor_places import sensor_bounds, straight_mm
from cellctl.config.checks.plausible.loads import G_M_S2
from cellctl.config.driver_settings import measuring_range
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.cycle import greatest_before_n
from cellctl.processes.peg_in_hole.plan.cycle_plan import search_task
from cellctl.processes.peg_in_hole.plausible.seat import SIGMAS, seat_bounds
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import FORCE
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.verdict.judgement import MOST_OF_GRIP
from cellctl.processes.peg_in_hole.verdict.lateral import push_force_n

_PUSHED_WITH_N = 2.0
"""Presses the peg while it is pushed to the sides (verdict/lateral.py): no search presses less."""
_MOST_TO_THE_SIDE = 0.9
"""Of insertion_n, what a push of the verdict may take: by half of what is left it may grow until
the arm has answered, and with nothing left it never moves."""
_MOST_OVER_INSERTION = 3.0
_MOST_LEVERS = 3.0
"""Most moment, as a multiple of what the greatest force makes on the whole length of the part."""


def force_bounds(
    cell: CellConfig, recipe: PegRecipe, settings: PegSettings, key: str
) -> Iterator[Bound]:
    """Forces that judge nothing, stop nothing, or cannot be reached."""
    yield from _contact(recipe, settings, f"{key}.forces")
    yield from _moments(recipe, f"{key}.forces")
    yield from _seat(recipe, settings, key)
    yield from _sensor(cell, recipe, key)


def _contact(recipe: PegRecipe, settings: PegSettings, where: str) -> Iterator[Bound]:
    forces = recipe.forces
    least_n = max(_PUSHED_WITH_N, SIGMAS * settings.force_sigma_n)
    why = f"what a peg is pressed with while it is pushed aside, and {SIGMAS:g} force_sigma_n"
    yield Bound(f"{where}.search_n", forces.search_n, why, least=least_n)
    why = "half of insertion_n: a search that presses like the insertion cannot be told from it"
    yield Bound(f"{where}.search_n", forces.search_n, why, most=forces.insertion_n / 2.0)
    push_n = push_force_n(search_task(recipe, settings).cell)
    why = (
        f"the verdict pushes sideways with {push_n:.3g} N, more than friction on a chamfer holds "
        f"(friction = {recipe.fit.friction:g}), and that is at most {_MOST_TO_THE_SIDE:g} times "
        "insertion_n"
    )
    least_n = push_n / _MOST_TO_THE_SIDE
    yield Bound(f"{where}.insertion_n", forces.insertion_n, why, least=least_n)
    why = f"{_MOST_OVER_INSERTION:g} times insertion_n, where a good insertion ends"
    most_n = _MOST_OVER_INSERTION * forces.insertion_n
    yield Bound(f"{where}.fault_n", forces.fault_n, why, most=most_n)


def _moments(recipe: PegRecipe, where: str) -> Iterator[Bound]:
    """About the tip: forces at the rim of the peg, from its front to its seat."""
    forces, fit = recipe.forces, recipe.fit
    halfway_n_m = forces.insertion_n * (fit.peg_radius_mm + fit.depth_mm / 2) * MM
    why = "insertion_n at the rim of a peg that is halfway in makes so much, and would be a fault"
    yield Bound(f"{where}.fault_nm", forces.fault_nm, why, least=halfway_n_m)
    whole_n_m = _MOST_LEVERS * forces.fault_n * (fit.peg_radius_mm + fit.depth_mm) * MM
    why = f"{_MOST_LEVERS:g} times fault_n at the rim of the part, over its radius and depth"
    yield Bound(f"{where}.fault_nm", forces.fault_nm, why, most=whole_n_m)


def _seat(recipe: PegRecipe, settings: PegSettings, key: str) -> Iterator[Bound]:
    forces, seat = recipe.forces, recipe.seat
    why = "insertion_n, at which the feed ends: a higher limit would judge nothing"
    yield Bound(f"{key}.seat.most_n", seat.most_n, why, most=forces.insertion_n)
    yield from seat_bounds(seat, settings.force_sigma_n, f"{key}.seat")
    if seat.pull_n is not None:
        why = "pull_n, which the part holds: with less it is never drawn out again"
        yield Bound(f"{key}.forces.withdrawal_n", forces.withdrawal_n, why, least=seat.pull_n)
    if recipe.fit.contacts is not None:
        why = "fit.contacts.least_n, which hold the part back: with less it is never drawn out"
        least_n = recipe.fit.contacts.least_n
        yield Bound(f"{key}.forces.withdrawal_n", forces.withdrawal_n, why, least=least_n)
    if seat.grip_n is not None:
        least_n = forces.insertion_n / MOST_OF_GRIP
        why = f"insertion_n over {MOST_OF_GRIP:g}, or no part could be told from one that slipped"
        yield Bound(f"{key}.seat.grip_n", seat.grip_n, why, least=least_n)
        before_n = greatest_before_n(search_task(recipe, settings))
        why = (
            f"{before_n:g} N, up to which the guard lets a search press, over {MOST_OF_GRIP:g}: "
            "the part may have slipped then, and none would be called inserted"
        )
        yield Bound(f"{key}.seat.grip_n", seat.grip_n, why, least=before_n / MOST_OF_GRIP)
        why = f"{MOST_OF_GRIP:g} times grip_n: with more the gripper slips off the part"
        most_n = MOST_OF_GRIP * seat.grip_n
        yield Bound(f"{key}.forces.withdrawal_n", forces.withdrawal_n, why, most=most_n)


def _sensor(cell: CellConfig, recipe: PegRecipe, key: str) -> Iterator[Bound]:
    """What the sensor clips, it neither measures nor stops at."""
    name = recipe.device(FORCE)
    sensor, load = cell.force_sensors[name], recipe.load
    weight_n = load.mass_kg * G_M_S2
    why = (
        f"its weight of {weight_n:.0f} N comes and goes when the arm turns over, and "
        f"force_sensors.{name}.free_force_n = {sensor.free_force_n:g} N stops free moves"
    )
    most_kg = sensor.free_force_n / G_M_S2
    yield Bound(f"{key}.load.mass_kg", load.mass_kg, why, most=most_kg)
    yield from sensor_bounds(cell, name, recipe.flange_T_tip)
    if (reach_mm := straight_mm(recipe.flange_T_tip)) is not None:
        before_mm = reach_mm - sensor.flange_T_sensor[2]
        why = f"z of the load: it hangs between the sensor and the tip, {before_mm:g} mm before it"
        z_mm = load.com_in_sensor_mm[2]
        yield Bound(f"{key}.load.com_in_sensor_mm", z_mm, why, least=0.0, most=before_mm)
    measuring = measuring_range(sensor)
    if not measuring:
        return
    clips_n = min(measuring[:3])
    why = f"the range of force_sensors.{name}, {clips_n:g} N, less the weight of the load"
    yield Bound(f"{key}.forces.fault_n", recipe.forces.fault_n, why, most=clips_n - weight_n)
    if recipe.seat.grip_n is not None:
        why = (
            f"the range of force_sensors.{name}: more was not measured with it; a lower figure is "
            "on the safe side"
        )
        yield Bound(f"{key}.seat.grip_n", recipe.seat.grip_n, why, most=clips_n)
