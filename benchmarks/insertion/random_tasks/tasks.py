"""Part, hole, cell and what the cell is told of them, drawn by a seed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from benchmarks.insertion.contact_world import DEAD_TIME_S
from benchmarks.insertion.cycles import CycleCell, CycleInjection
from benchmarks.insertion.farmed import shipped_cell
from benchmarks.insertion.fault_cycles import CycleFault, injected
from benchmarks.insertion.random_tasks.draws import Draws
from benchmarks.insertion.random_tasks.truths import Truth, injection_of
from fakes.scenes.socket.scenario import SocketScenario

_FACE_CLEAR_MM = 1.0
"""The face is touched so far beside all places at which the hole may be."""
_TRUTHS: tuple[Truth | CycleFault, ...] = (*Truth, *CycleFault)
_AS_TOLD_SHARE = 0.4
_CONTACTS_FROM, _CONTACTS_FULL = 0.6, 0.65
"""Shares of the depth at which contacts begin to rub, and from which on all of them do."""


@dataclass(frozen=True, slots=True, eq=False)
class RandomTask:
    """One task with its truth."""

    cell: CycleCell
    truth: Truth | CycleFault
    injection: CycleInjection


def random_task(seed: int) -> RandomTask:
    """The same seed gives the same task.

    Raises what refuses a recipe before any motion.
    """
    draws = Draws(seed)
    plug = draws.chance(0.3)
    fit = _plug(draws) if plug else _pin(draws)
    truth: Truth | CycleFault = Truth.AS_TOLD
    if not draws.chance(_AS_TOLD_SHARE):
        truth = _TRUTHS[int(draws.rng.integers(1, len(_TRUTHS)))]
    cell = _cell(draws, shipped_cell("connector" if plug else "pin"), fit, truth)
    if isinstance(truth, CycleFault):
        return RandomTask(cell, truth, injected(cell, truth, seed))
    return RandomTask(cell, truth, injection_of(draws, cell, truth, seed))


def _pin(draws: Draws) -> dict[str, Any]:
    radius = draws.between(1.5, 10.0)
    chamfers = [draws.between(0.2, 1.0) if draws.chance(0.7) else 0.0 for _ in range(2)]
    peg_chamfer = min(chamfers[1], 0.3 * radius)
    return {
        "peg_radius_mm": radius,
        "clearance_mm": draws.magnitude(0.01, 0.2),
        "hole_chamfer_mm": chamfers[0],
        "peg_chamfer_mm": peg_chamfer,
        "depth_mm": chamfers[0] + peg_chamfer + draws.between(2.0, 18.0),
        "friction": draws.between(0.1, 0.35),
    }


def _plug(draws: Draws) -> dict[str, Any]:
    fit = _pin(draws)
    fit["peg_radius_mm"] = draws.between(6.0, 16.0)
    fit["clearance_mm"] = draws.magnitude(0.05, 0.3)
    fit["depth_mm"] = draws.between(7.0, 12.0)
    mouth = fit["peg_radius_mm"] + fit["clearance_mm"] + fit["hole_chamfer_mm"]
    fit["outer_radius_mm"] = mouth + draws.between(1.0, 4.0)
    if draws.chance(0.6):
        fit["keys"] = {
            "depth_mm": fit["hole_chamfer_mm"] + fit["peg_chamfer_mm"] + draws.between(1.5, 3.0),
            "window_deg": draws.between(0.7, 2.0),
            "uncertainty_deg": draws.between(1.0, 3.0),
        }
    return fit


def _cell(
    draws: Draws, shipped: CycleCell, fit: Mapping[str, Any], truth: Truth | CycleFault
) -> CycleCell:
    uncertainty = draws.magnitude(0.5, 5.0)
    rim = fit["peg_radius_mm"] - fit["peg_chamfer_mm"]
    mouth = fit["peg_radius_mm"] + fit["clearance_mm"] + fit["hole_chamfer_mm"]
    outer = fit.get("outer_radius_mm")
    proud = draws.between(8.0, 14.0)
    search_n = draws.between(5.0, 10.0)
    insertion_n = draws.between(25.0, 80.0)
    contacts_n = draws.between(5.0, 0.4 * insertion_n) if outer is not None else 0.0
    grip_n = insertion_n / 0.6 * draws.between(1.0, 2.0)
    axial = draws.magnitude(5e4, 8e5)
    noise_n = draws.magnitude(0.05, 0.5)
    turning = draws.magnitude(30.0, 400.0)
    recipe = shipped.recipe.model_dump(exclude_unset=True)
    recipe["fit"] = {**fit, "friction": fit["friction"] + draws.between(-0.03, 0.03)}
    if contacts_n > 0:
        recipe["fit"]["contacts"] = {
            "depth_mm": _CONTACTS_FROM * fit["depth_mm"],
            "full_mm": _CONTACTS_FULL * fit["depth_mm"],
            "least_n": 0.6 * contacts_n,
            "most_n": contacts_n,
        }
    recipe["base_T_hole"] |= {
        "uncertainty_mm": uncertainty,
        "height_uncertainty_mm": 2.0,
        "face_radius_mm": (mouth if outer is None else outer) + rim + uncertainty + _FACE_CLEAR_MM,
        "datum_depth_mm": 0.0 if outer is None else proud,
    }
    recipe["forces"] |= {
        "search_n": search_n,
        "insertion_n": insertion_n,
        "fault_n": insertion_n * draws.between(1.25, 1.7),
        "fault_nm": draws.between(1.0, 3.0),
    }
    least_n = max(draws.between(3.0, 8.0), 1.1 * contacts_n)
    recipe["seat"] = {"least_n": least_n, "most_n": insertion_n, "grip_n": grip_n}
    if contacts_n > 0:
        recipe["seat"]["pull_n"] = max(0.4 * contacts_n, 1.5)
    repeatability = draws.magnitude(0.005, 0.03)
    height_sigma = draws.magnitude(0.003, 0.012)
    # In series with the contact it is a little softer than the arm alone: a bound that holds.
    told_n_mm = 1e-3 * axial * draws.between(1.0, 1.3)
    settings = shipped.settings.model_dump(exclude_unset=True) | {
        "stiffness_n_mm": told_n_mm,
        "dead_time_ms": 1e3 * DEAD_TIME_S * draws.between(1.0, 1.5) * draws.sluggish,
        "repeatability_mm": repeatability,
        "height_sigma_mm": height_sigma,
        "force_sigma_n": 0.5 * noise_n,
    }
    true = _true_scenario(
        shipped.scenario,
        {
            **{key: value for key, value in fit.items() if key not in ("clearance_mm", "keys")},
            "bore_radius_mm": fit["peg_radius_mm"] + fit["clearance_mm"],
            "friction": draws.between(0.4, 0.6) if truth is Truth.ROUGH else fit["friction"],
            "proud_mm": None if outer is None else proud,
            "contacts": _contacts(fit["depth_mm"], contacts_n),
            "keys": _true_keys(fit.get("keys")),
        },
        {
            "lateral_p99_mm": uncertainty,
            "height_spread_mm": 2.0,
            "tilt_spread_deg": draws.between(0.0, 1.5),
            "yaw_spread_deg": 0.8 * fit["keys"]["uncertainty_deg"] if "keys" in fit else 2.0,
        },
        {
            "axial_n_m": axial * (draws.between(1.5, 3.0) if truth is Truth.STIFF else 1.0),
            "lateral_n_m": axial * draws.between(0.5, 1.0),
            "turning_nm_rad": turning,
            "yaw_nm_rad": turning,
        },
    )
    held = {
        "xyz_mm": (draws.between(0.0, 0.3),) * 3,
        # The turn of the grip and that of the socket are both within the uncertainty together.
        "rotation_deg": (draws.between(0.0, 0.4),) * 2 + (0.2,),
    }
    grip = true.peg.grip.model_copy(update=held)
    peg = true.peg.model_copy(update={"grip": grip, "grip_force_n": grip_n})
    sensor = true.force_sensors[peg.force_sensor].model_copy(
        update={"noise_n": noise_n, "noise_nm": 0.025 * noise_n}
    )
    scenario = true.model_copy(update={"peg": peg, "force_sensors": {peg.force_sensor: sensor}})
    return CycleCell.told(scenario, recipe, settings)


def _true_scenario(
    scenario: SocketScenario,
    fit: Mapping[str, Any],
    socket: Mapping[str, Any],
    compliance: Mapping[str, Any],
) -> SocketScenario:
    return scenario.model_copy(
        update={
            "fit": type(scenario.fit).model_validate(fit),
            "socket": scenario.socket.model_copy(update=socket),
            "compliance": scenario.compliance.model_copy(update=compliance),
        }
    )


def _true_keys(told: Mapping[str, float] | None) -> Mapping[str, float] | None:
    return None if told is None else {name: told[name] for name in ("depth_mm", "window_deg")}


def _contacts(depth_mm: float, force_n: float) -> tuple[tuple[float, float], ...]:
    if force_n == 0.0:
        return ()
    return (
        (_CONTACTS_FROM * depth_mm, 0.0),
        (_CONTACTS_FULL * depth_mm, force_n),
        (depth_mm, 0.75 * force_n),
    )
