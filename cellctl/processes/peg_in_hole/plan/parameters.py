"""Speeds, pitches, angles and thresholds of a search, from the figures of its task.

Nothing else tunes a search: a parameter changes when, and only when, one of its inputs does.
Source: sections 1, 3.2, 3.4 and 3.6 of the study of insertion by touch.
"""

from dataclasses import dataclass
from math import radians
from typing import Any

from cellctl.force.contact.streamed import speeds
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.force.contact.streamed.speeds import DETECTION_S
from cellctl.processes.peg_in_hole.plan.derived import Derived
from cellctl.processes.peg_in_hole.plan.task import SearchTask

_TOUCH_N = 8.0
"""Force by which a contact may grow, and with which a search presses, where the recipe allows
it."""
_FASTEST_SLIDE_M_S = 5e-3
"""No slide over a face is faster, however wide the catch radius is (section 3.2)."""
_LEAST_SPIRAL_SHARE = 0.4
"""Of the press, in a spiral: with less a lost face would not stand out of the noise."""
_SIDE_N = 5.0
"""Force with which the peg is held against the outer face of a plug (section 3.6)."""
STANDS_M = 0.05e-3
"""A peg that something carries stands as long as it goes no deeper than this."""
_LONGER, _SETTLE_S = 1.5, 0.5
"""A motion that only a force drives may take so much longer than its way at full speed."""


@dataclass(frozen=True, slots=True)
class SearchParameters:
    """Every number that the strategies use; see the formulas in ``search_parameters``."""

    press_n: Derived
    touch_speed: Derived
    catch: Derived
    pitch: Derived
    slide_speed: Derived
    spiral_press: Derived
    side_force: Derived
    tilt: Derived
    tilted_dip: Derived
    dip_threshold: Derived
    wall_threshold: Derived
    sink_speed: Derived
    entry_time: Derived
    give_way_time: Derived
    stand_time: Derived

    def to_record(self) -> list[dict[str, Any]]:
        """Formula and inputs of all of them."""
        return [getattr(self, name).to_record() for name in self.__slots__]


def touch_speed_m_s(stiffness_n_m: float, dead_time_s: float, growth_n: float = _TOUCH_N) -> float:
    """Greatest speed at which a contact grows by ``growth_n`` before the arm has answered."""
    return speeds.touch_speed_m_s(LoopFigures(stiffness_n_m, dead_time_s), growth_n)


def search_parameters(task: SearchTask) -> SearchParameters:
    """All parameters of a task."""
    fit, cell = task.fit, task.cell
    radius_m, catch_m = fit.peg_radius_m, fit.catch_radius_m
    entry_m = fit.entry_depth_m
    press_n = min(_TOUCH_N, task.limits.search_n)
    stiffness, dead_s, friction = cell.stiffness_n_m, cell.dead_time_s, cell.friction
    loop = {"k": stiffness, "θ": dead_s, "t_det": DETECTION_S}
    # The dip has to stand out of the noise of a height. In the study a tilt of 3° found 82 % of the
    # holes, one of 5 to 12° at least 99.7 % (section 3.3).
    tilt_rad = min(max(max(0.4e-3, 28 * cell.height_sigma_m) / radius_m, radians(4)), radians(12))
    heights = {"r": radius_m, "σ_z": cell.height_sigma_m}
    dip_m = radius_m * tilt_rad
    touch_m_s = touch_speed_m_s(stiffness, dead_s, press_n)
    sink_m_s = min(press_n / (1.5 * cell.loop_n_s_m), touch_m_s)
    yield_m_s = min(press_n / (4.5 * cell.loop_n_s_m), touch_m_s)
    pressed = {"F": press_n, "k": stiffness, "θ": dead_s, "v_t": touch_m_s}
    return SearchParameters(
        Derived("press", press_n, "N", "min(8 N, F_search)", {"F_search": task.limits.search_n}),
        Derived(
            "touch speed",
            touch_m_s,
            "m/s",
            "min(3 mm/s, ΔF / (k (θ + t_det)))",
            {"ΔF": press_n, **loop},
        ),
        Derived(
            "catch radius",
            catch_m,
            "m",
            "c + max(ch_hole + ch_peg - 0.1 mm, 0)",
            {"c": fit.clearance_m, "ch_hole": fit.hole_chamfer_m, "ch_peg": fit.peg_chamfer_m},
        ),
        # At this pitch the path passes the hole's axis within 0.8 C, and so crosses the circle in
        # which the peg falls in on a chord of 1.2 C at least: the slide speed rests on that chord.
        Derived("pitch", 1.6 * catch_m, "m", "1.6 C", {"C": catch_m}),
        Derived(
            "slide speed",
            min(_FASTEST_SLIDE_M_S, 0.96 * catch_m / (DETECTION_S + dead_s / 2)),
            "m/s",
            "min(5 mm/s, 0.96 C / (t_det + θ / 2))",
            {"C": catch_m, "θ": dead_s, "t_det": DETECTION_S},
        ),
        # Friction holds a peg back by μ F / k, and edges that cross in a tight mouth by more: where
        # that is much of the catch radius, whole turns of a spiral would only bend the arm.
        Derived(
            "press of a spiral",
            min(press_n, max(_LEAST_SPIRAL_SHARE * press_n, 0.5 * catch_m * stiffness / friction)),
            "N",
            "min(F, max(0.4 F, C k / 2 μ))",
            {"F": press_n, "C": catch_m, "k": stiffness, "μ": friction},
        ),
        Derived("side force", _SIDE_N, "N", "5 N", {}),
        Derived("tilt", tilt_rad, "rad", "clamp(max(0.4 mm, 28 σ_z) / r, 4°, 12°)", heights),
        Derived("tilted dip", dip_m, "m", "r θ_t", {"r": radius_m, "θ_t": tilt_rad}),
        Derived(
            "dip threshold",
            max(0.12 * dip_m, 4 * cell.height_sigma_m),
            "m",
            "max(0.12 r θ_t, 4 σ_z)",
            {"θ_t": tilt_rad, **heights},
        ),
        Derived(
            "wall threshold",
            cell.friction * press_n + 3 * cell.force_sigma_n,
            "N",
            "μ F_z + 3 σ_F",
            {"μ": cell.friction, "F_z": press_n, "σ_F": cell.force_sigma_n},
        ),
        # A press moves the arm at F / S only, with S = 1.5 n k θ for the n axes that one contact
        # loads: one on a face, three on a chamfer (section 4.1).
        Derived("sink speed", sink_m_s, "m/s", "min(F / (1.5 k θ), v_t)", pressed),
        Derived(
            "entry time",
            _LONGER * entry_m / sink_m_s + _SETTLE_S,
            "s",
            "1.5 z_e / v_s + 0.5 s",
            {"z_e": entry_m, "v_s": sink_m_s},
        ),
        Derived(
            "give-way time",
            _LONGER * catch_m / yield_m_s + _SETTLE_S,
            "s",
            "1.5 C / min(F / (4.5 k θ), v_t) + 0.5 s",
            {"C": catch_m, **pressed},
        ),
        Derived(
            "stand time",
            2 * STANDS_M / sink_m_s + _SETTLE_S,
            "s",
            "2 · 0.05 mm / v_s + 0.5 s",
            {"v_s": sink_m_s},
        ),
    )
