"""Single figures that the sweep of slips found to pass, and that hurt."""

from tests.unit.config.mistake import Mistake, deck

_PEG = "processes.peg-in-hole"
_PLUG = "processes.antenna-module"
_MATING = "recipes.0.mating"


def _pin(old: str, new: str, key: str, said: str, *, at_the_other: bool = False) -> Mistake:
    return Mistake("insertion-pin.toml", old, new, key, said, at_the_other=at_the_other)


def _connector(old: str, new: str, key: str, said: str, *, at_the_other: bool = False) -> Mistake:
    return Mistake("insertion-connector.toml", old, new, key, said, at_the_other=at_the_other)


def _antenna(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("antenna.toml", old, new, key, said)


_DECK = (
    deck(
        "max_speed_mm_s = 100.0",
        "max_speed_mm_s = 1000.0",
        "robots.main.settings.max_speed_mm_s",
        "at most 400: the driver takes commands up to it, and with max_deadman_s = 1.5 an arm",
    ),
    deck("over_travel_mm = 10.0", "over_travel_mm = 100.0", "recipes.0.over_travel_mm", "hard end"),
    deck(
        "seated_limit_about_x_deg = 0.02",
        "seated_limit_about_x_deg = 0.2",
        "recipes.0.seated_limit_about_x_deg",
        "at most 0.14",
    ),
    deck(
        "deck_thickness_sigma_mm = 0.012",
        "deck_thickness_sigma_mm = 0.0012",
        "recipes.0.deck_thickness_sigma_mm",
        "grade IT5 of 15 mm",
    ),
    deck(
        "travel_sigma_mm = 0.01", "travel_sigma_mm = 0.001", f"{_MATING}.travel_sigma_mm", "0.003"
    ),
    deck("step_sigma_mm = 0.003", "step_sigma_mm = 0.0003", f"{_MATING}.step_sigma_mm", "encoders"),
    deck(
        "range = [5000.0, 5000.0, 5000.0,",
        "range = [5000.0, 5000.0, 50000.0,",
        "force_sensors.force.settings.range",
        "data sheet",
    ),
)
_FORCES = (
    _pin("fault_n = 50.0", "fault_n = 500.0", "recipes.0.forces.fault_n", "3 times insertion_n"),
    _pin(
        "insertion_n = 30.0\nfault_n = 50.0",
        "insertion_n = 80.0\nfault_n = 195.0",
        "recipes.0.forces.fault_n",
        "range of",
    ),
    _pin("fault_nm = 1.0", "fault_nm = 10.0", "recipes.0.forces.fault_nm", "at most 2.25"),
    _pin("fault_nm = 1.0", "fault_nm = 0.1", "recipes.0.forces.fault_nm", "halfway in"),
    _pin("search_n = 8.0", "search_n = 0.8", "recipes.0.forces.search_n", "pushed aside"),
    _pin("most_n = 30.0", "most_n = 300.0", "recipes.0.seat.most_n", "judge nothing"),
    _pin("least_n = 5.0", "least_n = 0.5", "recipes.0.seat.least_n", "only noise"),
    _pin("grip_n = 60.0", "grip_n = 600.0", "recipes.0.seat.grip_n", "safe side"),
    _pin("grip_n = 60.0", "grip_n = 6.0", "recipes.0.seat.grip_n", "slipped"),
    _pin("mass_kg = 1.1", "mass_kg = 11.0", "recipes.0.load.mass_kg", "weight of 108 N"),
    _connector(
        "withdrawal_n = 50.0", "withdrawal_n = 500.0", "recipes.0.forces.withdrawal_n", "slips off"
    ),
    _connector(
        "withdrawal_n = 50.0", "withdrawal_n = 5.0", "recipes.0.forces.withdrawal_n", "drawn out"
    ),
    _connector("least_n = 40.0", "least_n = 4.0", "recipes.0.seat.least_n", "going in takes more"),
    _connector("pull_n = 8.0", "pull_n = 0.8", "recipes.0.seat.pull_n", "proves nothing"),
)
_LOOP = (
    _pin("stiffness_n_mm = 120.0", "stiffness_n_mm = 12.0", f"{_PEG}.stiffness_n_mm", "98.05"),
    _pin("dead_time_ms = 60.0", "dead_time_ms = 20.0", f"{_PEG}.dead_time_ms", "25.74"),
    _pin("dead_time_ms = 60.0", "dead_time_ms = 6.0", f"{_PEG}.dead_time_ms", "two setpoints"),
    _pin(
        "repeatability_mm = 0.02", "repeatability_mm = 0.002", f"{_PEG}.repeatability_mm", "sheet"
    ),
    _pin("height_sigma_mm = 0.01", "height_sigma_mm = 0.001", f"{_PEG}.height_sigma_mm", "joints"),
    _pin("force_sigma_n = 0.1", "force_sigma_n = 0.01", f"{_PEG}.force_sigma_n", "dead sensor"),
    _pin(
        "max_stream_travel_mm = 60.0",
        "max_stream_travel_mm = 6.0",
        "robots.arm.settings.max_stream_travel_mm",
        "end in contact",
    ),
    _pin(
        "face_radius_mm = 8.0",
        "face_radius_mm = 80.0",
        "robots.arm.settings.max_stream_travel_mm",
        "to the touches of the face",
        at_the_other=True,
    ),
    _pin(
        "max_stream_travel_deg = 15.0",
        "max_stream_travel_deg = 1.5",
        "robots.arm.settings.max_stream_travel_deg",
        "tilts and turns the part",
    ),
    _pin(
        "base_T_hole]\npose = [500.0, -200.0",
        "base_T_hole]\npose = [500.0, 200.0",
        "robots.arm.poses_deg.above_hole",
        "400 mm beside it",
        at_the_other=True,
    ),
)
_FIT = (
    _pin(
        "peg_chamfer_mm = 0.5", "peg_chamfer_mm = 5.0", "recipes.0.fit.peg_chamfer_mm", "no front"
    ),
    _pin("depth_mm = 12.0", "depth_mm = 1.2", "recipes.0.fit.depth_mm", "between the walls"),
    _pin("friction = 0.2", "friction = 0.02", "recipes.0.fit.friction", "no dry pair"),
    _pin(
        "uncertainty_mm = 2.0",
        "uncertainty_mm = 20.0",
        "recipes.0.base_T_hole.face_radius_mm",
        "may be 16 mm off",
        at_the_other=True,
    ),
    _connector(
        "outer_radius_mm = 16.5", "outer_radius_mm = 1.65", "recipes.0.fit.outer_radius_mm", "bore"
    ),
    _connector("depth_mm = 3.0,", "depth_mm = 30.0,", "recipes.0.fit.keys.depth_mm", "at most 10"),
    _connector("depth_mm = 3.0,", "depth_mm = 0.3,", "recipes.0.fit.keys.depth_mm", "at least 0.9"),
    _connector(
        "uncertainty_deg = 1.8",
        "uncertainty_deg = 18.0",
        "robots.arm.settings.max_stream_travel_deg",
        "at least 30.5",
        at_the_other=True,
    ),
)
_PLUGGING = (
    _antenna("rp_mm = 0.02", "rp_mm = 0.002", f"{_PLUG}.arm.rp_mm", "no data sheet"),
    _antenna("rp_deg = 0.001", "rp_deg = 0.0001", f"{_PLUG}.arm.rp_deg", "links of 1378 mm"),
    _antenna(
        "absolute_error_mm = 0.26",
        "absolute_error_mm = 0.026",
        f"{_PLUG}.arm.absolute_error_mm",
        "better than it repeats",
    ),
    _antenna("drift_mm = 0.024", "drift_mm = 0.0024", f"{_PLUG}.arm.drift_mm", "warm by 0.5 K"),
    _antenna(
        "square_mm = 1.5", "square_mm = 15.0", f"{_PLUG}.square_mm", "not fit into the picture"
    ),
    _antenna("square_mm = 1.5", "square_mm = 0.15", f"{_PLUG}.square_mm", "less than 4 mm"),
    Mistake(
        "antenna.toml",
        "closed_sensor = 1",
        "closed_sensor = 0",
        "grippers.gripper.settings.opened_sensor",
        "different addresses",
        at_the_other=True,
    ),
    _antenna(
        "tray_look = [41.42367",
        "tray_look = [-41.42367",
        "robots.arm.poses_deg.tray_look",
        "beside it",
    ),
)

_SENSOR = "force_sensors.force.flange_T_sensor"
_PLACES = (
    deck("flange_T_sensor = [0.0, 0.0, 60.0", "flange_T_sensor = [0.0, 0.0, 600.0", _SENSOR, "502"),
    deck("flange_T_sensor = [0.0, 0.0, 60.0", "flange_T_sensor = [0.0, 0.0, -60.0", _SENSOR, "502"),
    _antenna(
        "flange_T_sensor = [0.0, 0.0, 30.0", "flange_T_sensor = [0.0, 0.0, 300.0", _SENSOR, "200"
    ),
    _pin("flange_T_sensor = [0.0, 0.0, 30.0", "flange_T_sensor = [0.0, 0.0, -30.0", _SENSOR, "200"),
    _pin("[0.0, 2.0, 60.0]", "[0.0, 2.0, 600.0]", "recipes.0.load.com_in_sensor_mm", "most 170"),
    _pin("[0.0, 2.0, 60.0]", "[0.0, 2.0, -60.0]", "recipes.0.load.com_in_sensor_mm", "least 0"),
)
_DRAWINGS = (
    Mistake(
        "antenna.toml",
        'socket = "connectors/micro-d-15-holes.toml"',
        'socket = "connectors/d-sub-15-holes.toml"',
        "recipes.0",
        "drawings that can be used",
        at_the_other=True,
    ),
    _antenna(
        'module_top = "connectors/module-top.toml"',
        'module_top = "connectors/gripper.toml"',
        "recipes.0.module_top",
        "gripper_marks names this file",
    ),
    _antenna(
        'plate_below = "connectors/reference-plate-below.toml"',
        'plate_below = "connectors/reference-plate-above.toml"',
        f"{_PLUG}.reference.plate_below",
        "plate_above names this file",
    ),
    _antenna(
        "module_mass_kg = 0.25",
        "seated_limit_mm = 5.0\nmodule_mass_kg = 0.25",
        "recipes.0.seated_limit_mm",
        "capture_mm",
    ),
    _antenna(
        "module_mass_kg = 0.25",
        "worst_contact_mm = 0.9\nmodule_mass_kg = 0.25",
        "recipes.0.worst_contact_mm",
        "capture_mm",
    ),
    _pin(
        "force_sigma_n = 0.1",
        "force_sigma_n = 0.1\npanel_shift_mm = 5.0",
        f"{_PEG}.panel_shift_mm",
        "nothing is compared",
    ),
)

_IN_LISTS = (
    deck(
        "com_mm = [30.0, 20.0, 460.0]",
        "com_mm = [30.0, 20.0, -460.0]",
        "robots.main.load.com_mm",
        "before the flange",
    ),
    _antenna(
        "shift_mm = [18.0, 6.0]",
        "shift_mm = [18.0, 60.0]",
        f"{_PLUG}.shift_mm",
        "corners of the board would leave the picture of the stored camera_1",
    ),
    _antenna(
        "flange_T_marks = [0.0, 0.0, 200.0,",
        "flange_T_marks = [0.0, 0.0, -200.0,",
        "recipes.0.flange_T_marks",
        "within 100 mm of the plug",
    ),
    _antenna(
        "reference_look = [16.15861,",
        "reference_look = [-16.15861,",
        "robots.arm.poses_deg.reference_look",
        "over the place that the recipe gives",
    ),
)

SINGLE_FIGURES = _IN_LISTS + _DECK + _FORCES + _LOOP + _FIT + _PLUGGING + _PLACES + _DRAWINGS
