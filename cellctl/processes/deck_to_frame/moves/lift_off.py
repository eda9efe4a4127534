"""Lifts the deck straight off the station, wherever the last run has left it."""

from functools import partial

from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.guarded_motion.guarded_moves import GuardedMove, WrenchTolerance, guarded_moves
from cellctl.cell.guarded_motion.kept_zero import Pressed, forget_zero, newest_raw
from cellctl.cell.guarded_motion.leaving import change_while_drawn_n, pressed_n
from cellctl.config.devices import ForceSensorConfig
from cellctl.errors.force import ForceLimitExceeded, LiftOffHeld
from cellctl.force.contact.leaving import FIRST_LIFT_M, leaving_speed_m_s
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.guard.limits import DEFAULT_FILTER_S
from cellctl.processes.deck_to_frame.poses.pose_limits import is_near
from cellctl.processes.deck_to_frame.recipe import DeckRecipe, Mating
from cellctl.processes.deck_to_frame.stations import DeckCell

_log = log.get(__name__)

LIFT_M = 0.06
"""Height above the seat at which the lift ends; from there the arm moves as in free space. Twice
``LOW_M``, so that a deck that was lifted is surely not low any more."""
SLOW_LIFT_M = 0.015
"""Height up to which the lift is slow: above pins of usual length. Longer ones are left at the
speed of the robot, under the guard as well."""
NEAR_SPEED_M_S = 2e-3
"""Speed where pins and edges are near: of the stretch after the first, and of the last one down."""
LOW_M = 0.03
"""A deck less than this above its seat is lifted before it goes anywhere else: above the stand-off,
where a mating begins, and all that a mating can leave."""
OVER_STATION_M = 0.1
"""A deck less than this above its seat is under the heads, where these stand over the station."""
_INWARDS = -1
"""Along z of the deck, which points away from the frame."""
NEAR_STATION_M = 0.8
"""Along either axis of the frame, between its middle and the deck's: they may overlap."""


async def lift_off(cell: DeckCell, payload: GravityCompensation | None = None) -> None:
    """Move the deck away from the station along the approach, slowly at first, under the guard.

    The direction is the normal of the frame as measured last, else as the recipe has it. Nothing
    moves when the deck is not low over the station. With the ``payload`` as it was identified, a
    deck that is pulled is known as one after a restart, too, which has forgotten the zero. Raises
    ``LiftOffHeld`` when the force changes by more than a mating may press, and the faults of guard
    and robot; the arm then stays stopped.
    """
    base_T_flange = cell.main.state().base_T_flange
    recipe = recipe_below(cell, base_T_flange)
    if recipe is None:
        return
    _log.info("lifting off the station")
    mating = recipe.mating
    # The normal of the frame and not the axis of the flange: a deck on pins must leave along them.
    away = _frame_of(cell, recipe).rotation.apply([0.0, 0.0, 1.0])
    flange_T_deck = pose_from_xyzabc(recipe.flange_T_deck)
    guarded = partial(guarded_moves, cell.cell, cell.arm, flange_T_deck)
    # Before the tare hides it.
    most_n = await _most_pressed_n(cell, recipe, payload)
    press_n = await pressed_n(cell.arm, _INWARDS, most_n)
    try:
        pressed = Pressed(_INWARDS, press_n)
        async with guarded(_tolerance(mating, press_n), leaves=pressed) as move:
            first_m_s = first_lift_speed_m_s(mating, cell.force_config)
            above = _above(base_T_flange, FIRST_LIFT_M * away)
            await move(cell.main.step(above, speed_m_s=first_m_s))
        # From a new zero: the first one was taken while the deck was pressed on the frame, so that
        # what is felt of a free deck is that force, and acceleration would come on top of it.
        # A deck that something yielding holds is pulled by then, not yet by enough to be noticed.
        held_n = min(0.0, await pressed_n(cell.arm, _INWARDS, mating.limit_force_n))
        pulled = Pressed(_INWARDS, held_n)
        async with guarded(_tolerance(mating, held_n), leaves=pulled) as move:
            await _rise(cell, mating, base_T_flange, away, move)
        await forget_zero(cell.arm)
    except ForceLimitExceeded as fault:
        raise LiftOffHeld(fault.detail) from fault


async def _most_pressed_n(
    cell: DeckCell, recipe: DeckRecipe, payload: GravityCompensation | None
) -> float:
    """Greatest force (N) with which the deck may be pressed on its frame while the zero is unknown.

    Negative where the deck is surely pulled.

    Without this each restart would forget a pull, and each Reset after one add as much again. The
    reading less the payload is off by what a run lets it be off before its own zero, because the
    sensor drifts and a compensation leaves something of the weight.
    """
    mating, guard = recipe.mating, cell.arm.guard
    told = guard.in_part_frame and guard.hidden_axial_n is not None
    if payload is None or told:
        return mating.limit_force_n
    raw = await newest_raw(guard)
    if raw is None:
        return mating.limit_force_n
    base_R_flange = cell.main.state().base_T_flange.rotation
    flange_R_sensor = cell.arm.flange_T_sensor.rotation
    contact = payload.apply(raw, base_R_flange * flange_R_sensor)
    flange_R_deck = pose_from_xyzabc(recipe.flange_T_deck).rotation
    along_n = float((flange_R_deck.inv() * flange_R_sensor).apply(contact[:3])[2])
    return min(mating.limit_force_n, -_INWARDS * along_n + mating.max_untared_force_n)


def _tolerance(mating: Mating, press_n: float) -> WrenchTolerance:
    """What a mating has left may go without a fault: never more than its own limits. A deck that an
    earlier attempt has left pulled may be pulled by the less; raises ``LiftOffHeld`` where that is
    nothing."""
    limit_n = mating.limit_force_n
    axial_n = min(limit_n, change_while_drawn_n(limit_n, press_n))
    return WrenchTolerance(limit_n, 2.0 * mating.max_moment_n_m, axial_n=axial_n)


def is_over_station(cell: DeckCell) -> bool:
    """Whether a recipe's deck on the flange would be over its frame, too low to leave upwards."""
    base_T_flange = cell.main.state().base_T_flange
    return any(
        _is_low(recipe, _frame_T_deck(recipe, base_T_flange), OVER_STATION_M)
        for recipe in cell.recipes
    )


async def _rise(
    cell: DeckCell, mating: Mating, base_T_flange: RigidTransform, away: Array, move: GuardedMove
) -> None:
    fast_m_s = cell.main_config.linear_speed_mm_s * MM
    for height_m, speed_m_s in ((SLOW_LIFT_M, NEAR_SPEED_M_S), (LIFT_M, fast_m_s)):
        await move(
            cell.main.move_linear(
                _above(base_T_flange, height_m * away),
                speed_m_s=speed_m_s,
                acceleration_m_s2=mating.acceleration_mm_s2 * MM,
            )
        )


def _above(base_T_flange: RigidTransform, way_m: Array) -> RigidTransform:
    return RigidTransform.from_translation(way_m) * base_T_flange


def first_lift_speed_m_s(mating: Mating, force: ForceSensorConfig) -> float:
    """Speed of the first stretch in m/s, from the recipe's bounds."""
    delay_s = (mating.stop_latency_ms + force.stale_ms) / 1e3 + DEFAULT_FILTER_S
    stiffness_n_m = mating.stiffness_n_per_mm / MM
    return leaving_speed_m_s(mating.limit_force_n, stiffness_n_m, delay_s, NEAR_SPEED_M_S)


def recipe_below(cell: DeckCell, base_T_flange: RigidTransform) -> DeckRecipe | None:
    """The recipe whose deck on the flange would be low over its frame.

    Where those of several would be, that of the last run; after a restart, when nobody knows which
    that was, the one that allows the least force.
    """
    low = [
        recipe
        for recipe in cell.recipes
        if _is_low(recipe, _frame_T_deck(recipe, base_T_flange), LOW_M)
    ]
    last = next((recipe for recipe in low if recipe.id == cell.memory.recipe_id), None)
    return last or min(low, key=lambda recipe: recipe.mating.limit_force_n, default=None)


def _frame_T_deck(recipe: DeckRecipe, base_T_flange: RigidTransform) -> RigidTransform:
    nominal = pose_from_xyzabc(recipe.base_T_frame)
    return nominal.inv() * base_T_flange * pose_from_xyzabc(recipe.flange_T_deck)


def _frame_of(cell: DeckCell, recipe: DeckRecipe) -> RigidTransform:
    """The frame as it was measured last, if that can be this recipe's frame; else nominal."""
    nominal, measured = pose_from_xyzabc(recipe.base_T_frame), cell.memory.base_T_frame
    return measured if measured is not None and is_near(recipe, nominal, measured) else nominal


def _is_low(recipe: DeckRecipe, frame_T_deck: RigidTransform, height_m: float) -> bool:
    x_m, y_m, z_m = frame_T_deck.translation
    low = z_m < recipe.deck_thickness_mm * MM + height_m
    return bool(low and max(abs(x_m), abs(y_m)) < NEAR_STATION_M)
