"""Which searches suit a task, how long each may take, and when to refuse before any contact.

Source: section 3.6 of the study of insertion by touch. In its estimates of time a touch costs 0.8 s
beside its way and a change of tilt 2.5 s; both are assumed there.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import pi
from typing import Any

from cellctl.processes.peg_in_hole.faults import HeightTooNoisy, SearchImpossible
from cellctl.processes.peg_in_hole.plan.derived import Derived
from cellctl.processes.peg_in_hole.plan.parameters import SearchParameters, search_parameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask

ARC_TOUCHES = 9
"""Touches along the outer face of a plug."""
_GREATEST_LOOP_N_S_M = 7e4
"""Stiffness times dead time beyond which no search for a tight hole ends within two minutes: the
best one found 97 of 100 at 6e4, and 27 at 7.2e4 (section 3.3)."""
_LEAST_DIP_SIGMAS = 14.0
"""Dip of a tilted peg in standard deviations of a height: edges are felt at 0.3 of the dip, which
are four standard deviations then (section 3.4)."""


class SearchName(StrEnum):
    """Strategies by the names that recipes use."""

    SPIRAL = "spiral"
    TILTED_VALLEY = "tilted-valley"
    ARC = "arc"
    PARTICLE_MAP = "particle-map"
    PATENT_MIDPOINT = "patent-midpoint"
    """The right triangle as printed: free first direction, midpoint of the hypotenuse."""
    PATENT_CIRCUMCENTRE = "patent-circumcentre"
    """The right triangle with its vertex at 45 degrees, and the centre through three points."""


TILTED = frozenset({SearchName.TILTED_VALLEY, SearchName.PARTICLE_MAP})
AROUND_A_PLUG = frozenset(
    {SearchName.ARC, SearchName.PATENT_MIDPOINT, SearchName.PATENT_CIRCUMCENTRE}
)
"""They need an outer face that the peg can leave."""


@dataclass(frozen=True, slots=True)
class SearchChoice:
    """The strategy to begin with, what follows when it finds nothing, and why."""

    order: tuple[SearchName, ...]
    estimates: Mapping[SearchName, Derived]
    """Estimated times of all strategies that the geometry allows, in seconds."""
    parameters: SearchParameters

    def to_record(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "order": [name.value for name in self.order],
            "estimates": [estimate.to_record() for estimate in self.estimates.values()],
            "parameters": self.parameters.to_record(),
        }


def is_wide(task: SearchTask) -> bool:
    """True when a spiral crosses the catch radius after few turns."""
    return task.fit.catch_radius_m >= task.cell.uncertainty_m / 10


def choose_search(task: SearchTask, wanted: SearchName | None = None) -> SearchChoice:
    """The default of 3.6, or the one that is ``wanted`` by name.

    Raises ``SearchImpossible`` or ``HeightTooNoisy`` with the figures that say why.
    """
    parameters = search_parameters(task)
    estimates = estimate_searches(task, parameters)
    # A recipe that names a search is taken at its word: nothing follows when it finds nothing.
    asked = _default_order(task, estimates) if wanted is None else (wanted,)
    if not is_wide(task) and task.cell.loop_n_s_m > _GREATEST_LOOP_N_S_M:
        raise SearchImpossible(
            f"k θ is {task.cell.loop_n_s_m:.3g} N·s/m, for a tight hole at most "
            f"{_GREATEST_LOOP_N_S_M:.0e}"
        )
    noisy = _noise_of_tilted(task, parameters)
    limit_s = task.search_limit_s
    order = tuple(
        name
        for name in asked
        if name in estimates
        and estimates[name].value <= limit_s
        and not (name in TILTED and noisy is not None)
    )
    if not order:
        # Noise is the reason only where no other search was asked for; else time is.
        if noisy is not None and all(name in TILTED for name in asked):
            raise HeightTooNoisy(noisy)
        raise SearchImpossible(_reason(asked, estimates, limit_s))
    return SearchChoice(order, estimates, parameters)


def _default_order(
    task: SearchTask, estimates: Mapping[SearchName, Derived]
) -> tuple[SearchName, ...]:
    on_plug = task.fit.rim_m is not None
    if is_wide(task):
        return (SearchName.SPIRAL, SearchName.ARC if on_plug else SearchName.TILTED_VALLEY)
    if on_plug:
        return (SearchName.ARC, SearchName.PATENT_CIRCUMCENTRE)
    # The slides of a valley are as long as the radius of the peg, at the speed of a touch; a spiral
    # is fast where the place is known well. It looks everywhere then, and the touches of a map are
    # no more precise than the attitude of a thick peg.
    in_time = estimates[SearchName.TILTED_VALLEY].value <= task.search_limit_s
    first = SearchName.TILTED_VALLEY if in_time else SearchName.SPIRAL
    return (first, SearchName.PARTICLE_MAP)


def _noise_of_tilted(task: SearchTask, parameters: SearchParameters) -> str | None:
    """Why tilted touches cannot be read; None when they can."""
    dip_m, sigma_m = parameters.tilted_dip.value, task.cell.height_sigma_m
    if dip_m >= _LEAST_DIP_SIGMAS * sigma_m:
        return None
    return (
        f"a tilted peg dips {dip_m * 1e3:.3f} mm into the hole, {dip_m / sigma_m:.1f} standard "
        f"deviations of a height; at least {_LEAST_DIP_SIGMAS:.0f} are needed"
    )


def _reason(
    asked: tuple[SearchName, ...], estimates: Mapping[SearchName, Derived], limit_s: float
) -> str:
    words = [
        f"{name.value}: {estimates[name].value:.0f} s"
        if name in estimates
        else f"{name.value}: the hole has no outer face"
        for name in asked
    ]
    return f"{'; '.join(words)}; the search may take {limit_s:.0f} s"


def estimate_searches(task: SearchTask, parameters: SearchParameters) -> dict[SearchName, Derived]:
    """Time of each strategy that the geometry allows."""
    return {
        name: estimate(task, parameters)
        for name, estimate in _ESTIMATES.items()
        if name not in AROUND_A_PLUG or task.fit.rim_m is not None
    }


def _spiral(task: SearchTask, parameters: SearchParameters) -> Derived:
    radius_m, pitch_m = task.search_radius_m, parameters.pitch.value
    speed = parameters.slide_speed.value
    return Derived(
        SearchName.SPIRAL,
        1 + pi * radius_m**2 / (pitch_m * speed),
        "s",
        "1 s + π (1.15 u)² / (1.6 C v)",
        {"u": task.cell.uncertainty_m, "C": parameters.catch.value, "v": speed},
    )


def _valley(task: SearchTask, parameters: SearchParameters) -> Derived:
    bore_m, speed = task.fit.bore_radius_m, parameters.touch_speed.value
    pecks = 1 + (task.cell.uncertainty_m / bore_m) ** 2
    slides_m = 1.8 * bore_m + 0.8 * task.fit.peg_radius_m
    return Derived(
        SearchName.TILTED_VALLEY,
        7.5 + pecks * (0.8 + 0.3e-3 / speed) + slides_m / speed,
        "s",
        "7.5 s + (1 + (u/R)²) (0.8 s + 0.3 mm / v_t) + (1.8 R + 0.8 r) / v_t",
        {
            "u": task.cell.uncertainty_m,
            "R": bore_m,
            "r": task.fit.peg_radius_m,
            "v_t": speed,
        },
    )


def _particle_map(_task: SearchTask, parameters: SearchParameters) -> Derived:
    speed = parameters.touch_speed.value
    return Derived(
        SearchName.PARTICLE_MAP,
        7.5 + 16 * (0.8 + 0.3e-3 / speed),
        "s",
        "7.5 s + 16 (0.8 s + 0.3 mm / v_t)",
        {"v_t": speed},
    )


def _arc(task: SearchTask, parameters: SearchParameters) -> Derived:
    rim_m = task.fit.rim_m or 0.0
    speed = parameters.touch_speed.value
    return Derived(
        SearchName.ARC,
        8 + 1.2 * rim_m / 5e-3 + ARC_TOUCHES * (0.8 + 0.3e-3 / speed) + 1e-3 / speed,
        "s",
        "8 s + 1.2 ρ / (5 mm/s) + n (0.8 s + 0.3 mm / v_t) + 1 mm / v_t",
        {"ρ": rim_m, "n": ARC_TOUCHES, "v_t": speed},
    )


def _patent(name: SearchName) -> Callable[[SearchTask, SearchParameters], Derived]:
    def estimate(task: SearchTask, _parameters: SearchParameters) -> Derived:
        rim_m = task.fit.rim_m or 0.0
        return Derived(
            name,
            8 + 6 * rim_m / 5e-3,
            "s",
            "8 s + 6 ρ / (5 mm/s)",
            {"ρ": rim_m},
        )

    return estimate


_ESTIMATES: Mapping[SearchName, Callable[[SearchTask, SearchParameters], Derived]] = {
    SearchName.SPIRAL: _spiral,
    SearchName.TILTED_VALLEY: _valley,
    SearchName.ARC: _arc,
    SearchName.PARTICLE_MAP: _particle_map,
    SearchName.PATENT_MIDPOINT: _patent(SearchName.PATENT_MIDPOINT),
    SearchName.PATENT_CIRCUMCENTRE: _patent(SearchName.PATENT_CIRCUMCENTRE),
}
