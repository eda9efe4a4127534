"""What is wrong with a task, and how the world of a cycle is made so."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import StrEnum

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.insertion.contact_world import Injected
from benchmarks.insertion.cycles import CycleCell, CycleInjection
from benchmarks.insertion.random_tasks.draws import Draws
from fakes.scenes.socket.part import PegPart, draw_part, nominal_fit
from fakes.world.frames import MM, displacement


class Truth(StrEnum):
    """What is wrong with a task, beside the faults of whole cycles."""

    AS_TOLD = "as the cell is told"
    TOO_DEEP = "hole deeper than drawn"
    NO_KEYWAYS = "keyways fit at no angle"
    ROUGH = "more friction than stated"
    STIFF = "arm stiffer than its bound"
    BEYOND = "hole beyond its uncertainty"
    FAR_FACE = "face beyond its uncertainty"
    STEEP_FACE = "face tilted by 4 to 8 degrees"
    PART_MISSING = "no part in the gripper"
    HELD_OTHERWISE = "part held 1 mm higher or lower"


_Made = Callable[[Draws, CycleCell, PegPart], CycleInjection]


def injection_of(draws: Draws, cell: CycleCell, truth: Truth, seed: int) -> CycleInjection:
    """What makes the truth another than the cell is told."""
    make = _MAKE.get(truth)
    return (
        CycleInjection() if make is None else make(draws, cell, draw_part(cell.scenario, seed, 1))
    )


def _too_deep(draws: Draws, cell: CycleCell, _part: PegPart) -> CycleInjection:
    fit = nominal_fit(cell.scenario.fit)
    deeper_m = draws.between(0.6, 4.0) * MM
    return CycleInjection(Injected(fit=replace(fit, depth_m=fit.depth_m + deeper_m)))


def _no_keyways(_draws: Draws, cell: CycleCell, _part: PegPart) -> CycleInjection:
    fit = nominal_fit(cell.scenario.fit)
    keys = None if fit.keys is None else replace(fit.keys, present=False)
    return CycleInjection(Injected(fit=replace(fit, keys=keys)))


def _moved_hole(part: PegPart, hole: RigidTransform) -> CycleInjection:
    return CycleInjection(part=replace(part, cell_T_hole=part.cell_T_hole * hole))


def _beyond(draws: Draws, cell: CycleCell, part: PegPart) -> CycleInjection:
    task = cell.plan.task
    away_m = task.search_radius_m + task.fit.bore_radius_m + draws.between(1.0, 5.0) * MM
    azimuth = draws.between(-np.pi, np.pi)
    return _moved_hole(
        part, displacement([away_m * np.cos(azimuth), away_m * np.sin(azimuth), 0], [0, 0, 0])
    )


def _far_face(draws: Draws, cell: CycleCell, part: PegPart) -> CycleInjection:
    lower_m = (cell.recipe.base_T_hole.height_uncertainty_mm + draws.between(3.0, 8.0)) * MM
    return _moved_hole(part, displacement([0, 0, -lower_m], [0, 0, 0]))


def _steep_face(draws: Draws, _cell: CycleCell, part: PegPart) -> CycleInjection:
    azimuth, tilt = draws.between(-np.pi, np.pi), np.radians(draws.between(4.0, 8.0))
    return _moved_hole(
        part, displacement([0, 0, 0], [tilt * np.cos(azimuth), tilt * np.sin(azimuth), 0])
    )


def _part_missing(_draws: Draws, _cell: CycleCell, part: PegPart) -> CycleInjection:
    return _held(part, 60.0 * MM)


def _held_otherwise(draws: Draws, _cell: CycleCell, part: PegPart) -> CycleInjection:
    return _held(part, MM if draws.chance(0.5) else -MM)


def _held(part: PegPart, higher_m: float) -> CycleInjection:
    shift = RigidTransform.from_translation([0.0, 0.0, higher_m])
    return CycleInjection(part=replace(part, flange_T_peg=part.flange_T_peg * shift))


_MAKE: Mapping[Truth, _Made] = {
    Truth.TOO_DEEP: _too_deep,
    Truth.NO_KEYWAYS: _no_keyways,
    Truth.BEYOND: _beyond,
    Truth.FAR_FACE: _far_face,
    Truth.STEEP_FACE: _steep_face,
    Truth.PART_MISSING: _part_missing,
    Truth.HELD_OTHERWISE: _held_otherwise,
}
