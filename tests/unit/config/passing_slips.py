"""Slips of the keyboard that `cellctl check` lets pass, each kind with its reason.

A pattern is a key and a slip of ``slips.py``, with ``*`` for the names of devices. Kinds without a
remark are on the safe side, end with a fault before any contact, or cannot be told from a good
value by anything that the file says.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Kind:
    """Slips that pass for one reason."""

    reason: str
    patterns: tuple[str, ...]
    remarked: bool | None = False
    """Whether `cellctl check` shows them beside a good file; None: in cells that have stored the
    calibration which tells."""


FIGURES = (
    Kind(
        "another address: which program listens there, only --connect finds",
        (
            "plc.port *",
            "*.settings.port *",
            "*.settings.command_port /10",
            "*.settings.state_port /10",
            "*.settings.guard_port /10",
        ),
    ),
    Kind(
        "slower: nobody is hurt, and the time is seen at the first move",
        (
            "robots.*.speed_percent /10",
            "robots.*.linear_speed_mm_s /10",
            "robots.*.linear_acceleration_mm_s2 /10",
        ),
    ),
    Kind(
        "protects sooner, down to what network and PC need",
        (
            "*.max_deadman_s /10",
            "*.stale_s /10",
            "*.max_stream_loss_s /10",
            "*.stale_ms /10",
            "*.flange_age_ms /10",
            "*.max_lag_s /10",
            "*.lost_tick_ms /10",
            "*.old_force_ms /10",
            "*.lost_force_ms /10",
            "*.reply_timeout_s /10",
            "processes.antenna-module.reference.every_h /10",
        ),
    ),
    Kind(
        "stops a free move at less force",
        (
            "force_sensors.force.free_force_n /10",
            "force_sensors.force.free_moment_n_m /10",
            "recipes.over_travel_mm /10",
        ),
    ),
    Kind(
        "fewer samples: the approach is planned slower by as much",
        ("force_sensors.force.settings.rate_hz /10",),
    ),
    Kind(
        "an upper bound that is higher, or a figure that is worse: what is planned from it is "
        "slower, or refused before any contact",
        (
            "processes.peg-in-hole.stiffness_n_mm x10",
            "processes.peg-in-hole.height_sigma_mm x10",
            "processes.antenna-module.arm.rp_deg x10",
            "processes.antenna-module.arm.absolute_error_mm x10",
            "processes.antenna-module.arm.drift_mm x10",
            "recipes.fit.clearance_mm /10",
            "recipes.fit.hole_chamfer_mm /10",
            "recipes.fit.peg_chamfer_mm /10",
            "recipes.fit.keys.window_deg /10",
        ),
    ),
    Kind(
        "what parts take is known to their drawings alone; beyond the sensor it never acts",
        ("recipes.mating.unexpected_force_n x10",),
        remarked=True,
    ),
    Kind(
        "given up after one measurement, before any contact (F430)",
        ("recipes.pose_correction.max_iterations /10",),
        remarked=True,
    ),
    Kind(
        "a hole or a face that vision knows so well; where it is not so, the search ends without "
        "force (F547, F549)",
        (
            "recipes.base_T_hole.uncertainty_mm /10",
            "recipes.base_T_hole.height_uncertainty_mm /10",
        ),
    ),
    Kind(
        "a lighter load: the tare takes it at the attitude of the insertion, and light parts exist",
        ("recipes.load.mass_kg /10",),
        remarked=True,
    ),
    Kind(
        "another module: it is weighed when it was picked, and refused then",
        ("recipes.module_mass_kg *",),
    ),
    Kind(
        "a board that would hang beside where camera II was measured",
        ("processes.antenna-module.flange_T_board_mm /10",),
        remarked=True,
    ),
    Kind("the number by which the line asks for it: the line's to say", ("recipes.id x10",)),
    Kind(
        "such parts and terminals exist",
        (
            "grippers.gripper.settings.close_valve x10",
            "grippers.gripper.settings.closed_sensor x10",
            "grippers.gripper.settings.part_sensor x10",
            "recipes.fit.clearance_mm x10",
            "recipes.fit.peg_radius_mm /10",
            "recipes.fit.keys.window_deg x10",
            "recipes.fit.keys.uncertainty_deg /10",
        ),
        remarked=True,
    ),
    Kind(
        "narrower than what was weighed: weighing again may be as exact",
        ("robots.main.load.tolerance_kg /10", "robots.main.load.tolerance_mm /10"),
        remarked=True,
    ),
)
"""Slips of single figures."""
