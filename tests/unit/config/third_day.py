"""Mistakes of a third day: parts, loads, zones and heads that do not go with each other."""

from pathlib import Path

from tests.unit.config.mistake import Mistake, deck, deck_elsewhere, drawn

_CONFIG = Path(__file__).parents[3] / "config"
_DECK, _FRAME, _BOTH = ("deck.toml",), ("frame.toml",), ("deck.toml", "frame.toml")
_RECIPE = "recipes.0"
_MATING = "recipes.0.mating"
_MEASURING = "[-3.29612, -67.1374, 90.69669, 0.0, 66.4407, -93.29612]"
_RETRACTED = "[-6.91545, -98.67699, 111.2808, 0.0, 77.39619, -96.91545]"
_CAMERA = "flange_T_camera = [-89.5, 0.0, 120.0, 0.0, 10.0, 0.0]"
_CAMERA_KEY = "stereo_cameras.head_1.flange_T_camera"
_MAIN_BOX = "main = { min_mm = [800.0, -1500.0, 300.0], max_mm = [2700.0, -300.0, 2600.0]"
_AUX_BOX = "aux_1 = { min_mm = [1450.0, -800.0, 600.0], max_mm = [2400.0, 800.0, 1900.0]"


def _real(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("cell.toml", old, new, key, said)


def _pin(old: str, new: str, key: str, said: str, *, at_the_other: bool = False) -> Mistake:
    return Mistake("insertion-pin.toml", old, new, key, said, at_the_other=at_the_other)


def _antenna(old: str, new: str, key: str, said: str, *, at_the_other: bool = False) -> Mistake:
    return Mistake("antenna.toml", old, new, key, said, at_the_other=at_the_other)


def _within(new: str, key: str, said: str, before: str = "stand_off_mm = 10.0") -> Mistake:
    """A further key of the recipe."""
    return deck(before, f"{new}\n{before}", key, said)


def _heads_exchanged() -> Mistake:
    text = (_CONFIG / "deck.toml").read_text()
    heads = text[text.index("[stereo_cameras.head_1]") : text.index("[trackers.tracker]")]
    exchanged = heads.replace('"aux_1"', '"?"').replace('"aux_2"', '"aux_1"').replace("?", "aux_2")
    return deck(heads, exchanged, "stereo_cameras.head_1.carried_by", "did you mean 'aux_1'? ")


def _second_recipe() -> Mistake:
    text = (_CONFIG / "deck.toml").read_text()
    recipe = text[text.index("[[recipes]]") :]
    copied = recipe.replace("id = 1\n", "id = 2\n")
    return deck(recipe, f"{recipe}\n{copied}", "recipes.1.name", "another name than that of")


_LOADS = (
    deck("[30.0, 20.0, 460.0]", "[0.03, 0.02, 0.46]", "robots.main.load.com_mm", "metres"),
    deck("mass_kg = 200.0", "mass_kg = 20.0", "robots.main.load.mass_kg", "at least 48"),
    deck("mass_kg = 200.0", "mass_kg = 2000.0", "robots.main.load.mass_kg", "at most 510 kg"),
    deck_elsewhere(
        "tolerance_kg = 12.0", "tolerance_kg = 120.0", "robots.main.load.mass_kg", "a quarter"
    ),
    deck(
        "mass_kg = 200.0\ncom_mm = [30.0, 20.0, 460.0]\ntolerance_kg = 12.0",
        "mass_kg = 20.0\ncom_mm = [30.0, 20.0, 460.0]\ntolerance_kg = 2.0",
        "robots.main.load.mass_kg",
        "max_untared_force_n = 80",
    ),
    deck("tolerance_mm = 30.0", "tolerance_mm = 300.0", "robots.main.load.tolerance_mm", "half of"),
    deck("tolerance_mm = 30.0", "tolerance_mm = 0.03", "robots.main.load.tolerance_mm", "at least"),
    deck(
        "tolerance_mm = 30.0",
        "tolerance_mm = 30.0\nnot_weighed_kg = 120.0",
        "robots.main.load.not_weighed_kg",
        "at most 100",
    ),
    deck(
        "stiffness_n_per_mm = 1000.0",
        "stiffness_n_per_mm = 10.0",
        f"{_MATING}.stiffness_n_per_mm",
        "would sag by 196 mm",
    ),
    deck(
        "stiffness_n_per_mm = 1000.0",
        "stiffness_n_per_mm = 400.0",
        f"{_MATING}.stiffness_n_per_mm",
        "more than 650.3, which the stored contact_stiffness_1 measured",
    ),
    deck(
        "stop_latency_ms = 300.0",
        "stop_latency_ms = 200.0",
        f"{_MATING}.stop_latency_ms",
        "more than 269.1, which the stored stop_latency measured",
    ),
    deck(
        "stale_ms = 300.0",
        "free_force_n = 20.0\nstale_ms = 300.0",
        "force_sensors.force.free_force_n",
        "at least 40",
    ),
    deck(
        "flange_T_sensor = [0.0, 0.0, 60.0, 0.0, 0.0, 0.0]",
        "flange_T_sensor = [0.0, 0.0, 60.0, 0.0, 0.0, 90.0]",
        "force_sensors.force.flange_T_sensor",
        "z points along",
    ),
    _pin("[0.0, 2.0, 60.0]", "[0.0, 0.002, 0.06]", "recipes.0.load.com_in_sensor_mm", "metres"),
)
_HEADS = (
    deck(
        f"measuring = {_MEASURING}\nretracted = {_RETRACTED}",
        f"measuring = {_RETRACTED}\nretracted = {_MEASURING}",
        "robots.aux_1.poses_deg.retracted",
        "did you exchange them?",
    ),
    _heads_exchanged(),
    deck(_CAMERA, _CAMERA.replace("-89.5", "89.5"), _CAMERA_KEY, "did you mean [-89.5, "),
    deck(_CAMERA, _CAMERA.replace("120.0", "-120.0"), _CAMERA_KEY, "241 mm and 0 deg away"),
    deck(
        _CAMERA, _CAMERA.replace("120.0, 0.0", "120.0, 180.0"), _CAMERA_KEY, "3 mm and 180 deg away"
    ),
    deck(
        "measuring = [-3.29612",
        "measuring = [3.29612",
        "robots.aux_1.poses_deg.measuring",
        "did you mean [-3.29612, ",
    ),
    deck_elsewhere(
        "dh = [[0.0, 675.0, 350.0",
        "dh = [[0.0, 350.0, 675.0",
        _CAMERA_KEY,
        "458 mm and 0 deg away",
    ),
    deck_elsewhere(
        "0.0, 33.6262, 90.0]",
        "0.0, 43.6262, 90.0]",
        f"{_RECIPE}.base_T_frame",
        "Or teach deck_measure again",
    ),
    deck(
        "0.0, 33.6262, 90.0]",
        "0.0, 39.6262, 90.0]",
        "robots.main.poses_deg.deck_measure",
        "outside of the picture of head_2",
    ),
    deck(
        "base_T_frame = [1900.0, 0.0, 400.0",
        "base_T_frame = [1900.0, 90.0, 400.0",
        f"{_RECIPE}.base_T_frame",
        "outside of the picture of head_2",
    ),
    deck(
        "[23.3, 30.0, 622.6,",
        "[23.3, 30.0, -622.6,",
        "processes.deck-to-frame.flange_T_target_board",
        "in the picture of head_1",
    ),
    deck(
        "622.6, 0.0, 0.0, 180.0]",
        "622.6, 0.0, 0.0, 90.0]",
        "processes.deck-to-frame.flange_T_target_board",
        "z of the board along",
    ),
)
_ZONES = (
    deck(
        _MAIN_BOX,
        _MAIN_BOX.replace("-1500.0", "300.0").replace("-300.0", "1500.0"),
        "zones.beside_head_1.robots.main.way_out",
        "'-y', where its taught pose home lies",
    ),
    deck(
        _AUX_BOX,
        _AUX_BOX.replace("[1450.0", "[-2400.0").replace("[2400.0", "[-1450.0"),
        "zones.beside_head_1.robots.aux_1",
        "a box into which aux_1 comes",
    ),
    deck('way_out = "+y"', 'way_out = "-y"', "zones.beside_head_1.robots.main.way_out", "'+y'"),
    deck('way_out = "-x"', 'way_out = "+x"', "zones.beside_head_1.robots.aux_1.way_out", "'-x'"),
)
_ADDRESSES = (
    _real(
        '"/var/lib/cellctl/calibration"',
        '"/etc/cellctl/calibration"',
        "calibration_dir",
        "such as '/var/lib/cellctl/calibration'",
    ),
    _real(
        'data_dir = "/var/lib/cellctl"',
        'data_dir = "/usr/share/cellctl"',
        "data_dir",
        "'/var/lib/cellctl'",
    ),
    deck(
        'host = "127.0.0.1", port = 7101',
        'host = "http://127.0.0.1", port = 7101',
        "stereo_cameras.head_1.settings.host",
        "did you mean '127.0.0.1'? ",
    ),
    deck(
        'host = "127.0.0.1", port = 7102',
        'host = "127.0.0.1:7102", port = 7102',
        "stereo_cameras.head_2.settings.host",
        "a port has a key of its own",
    ),
    _real(
        'allowed_clients = ["192.168.10.2"]',
        'allowed_clients = ["192.168.10.1"]',
        "plc.allowed_clients",
        "this one is of this PC",
    ),
    _real(
        '"192.168.0.108"',
        '"192.168.20.1"',
        "force_sensors.force.settings.host",
        "this PC itself has this one",
    ),
    Mistake(
        "deck-gige.toml",
        "exposure_s = 0.008",
        "exposure_s = 8.0",
        "stereo_cameras.head_1.settings.exposure_s",
        "milliseconds",
    ),
)
_LIMITS = (
    _within("seated_limit_mm = 2.0", f"{_RECIPE}.seated_limit_mm", "10 times threshold_mm"),
    deck(
        "threshold_about_x_deg = 0.014",
        "threshold_about_z_deg = 0.012",
        f"{_RECIPE}.pose_correction.threshold_about_z_deg",
        "seated_limit_deg lets the seated deck have",
    ),
    _within("seated_limit_deg = 1.0", f"{_RECIPE}.seated_limit_deg", "10 times threshold_deg"),
    _within("seated_gap_limit_mm = 2.0", f"{_RECIPE}.seated_gap_limit_mm", "at most 0.5"),
    _within("station_tolerance_mm = 100.0", f"{_RECIPE}.station_tolerance_mm", "at most 50"),
    _within("station_tolerance_deg = 20.0", f"{_RECIPE}.station_tolerance_deg", "at most 8"),
    _within(
        "frames = 20", f"{_RECIPE}.pose_correction.frames", "at most 12", "max_iterations = 10"
    ),
    _within(
        "max_correction_mm = 0.01",
        f"{_RECIPE}.pose_correction.max_correction_mm",
        "at least 0.05",
        "max_iterations = 10",
    ),
    _within(
        "touch_force_n = 40.0", f"{_MATING}.touch_force_n", "at most 35", "target_force_n = 35.0"
    ),
    _within(
        "max_lateral_force_n = 250.0",
        f"{_MATING}.max_lateral_force_n",
        "at most 50",
        "target_force_n = 35.0",
    ),
    _within(
        "max_moment_n_m = 250.0",
        f"{_MATING}.max_moment_n_m",
        "at most 50",
        "target_force_n = 35.0",
    ),
    _second_recipe(),
    _antenna(
        "-200.0, 200.0, 180.0, 0.0, 0.0]",
        "-200.0, -200.0, 180.0, 0.0, 0.0]",
        "recipes.0.base_T_socket.pose",
        "with the plug in the socket the flange is at",
    ),
    _antenna(
        "flange_T_plug = [0.0, 0.0, 200.0",
        "flange_T_plug = [0.0, 0.0, 20.0",
        "recipes.0.base_T_tray_plug.pose",
        "when it picks",
        at_the_other=True,
    ),
    _pin(
        "pose = [500.0, -200.0, 200.0",
        "pose = [500.0, -200.0, 2000.0",
        "recipes.0.base_T_hole.pose",
        "at the face the flange is at",
    ),
    _pin(
        "flange_T_tip = [0.0, 0.0, 200.0",
        "flange_T_tip = [0.0, 0.0, -200.0",
        "recipes.0.base_T_hole.pose",
        "at the face",
        at_the_other=True,
    ),
    _pin(
        "depth_mm = 12.0",
        "depth_mm = 120.0",
        "recipes.0.fit.depth_mm",
        "at the seat",
    ),
    _pin(
        "peg_radius_mm = 3.0",
        "peg_radius_mm = 6.0",
        "recipes.0.base_T_hole.face_radius_mm",
        "peg_radius_mm is a diameter",
        at_the_other=True,
    ),
    _pin(
        "face_radius_mm = 8.0",
        "face_radius_mm = 2.0",
        "recipes.0.base_T_hole.face_radius_mm",
        "at least 7.65",
    ),
)

IN_CELL_FILES = _LOADS + _HEADS + _ZONES + _ADDRESSES + _LIMITS

_P3 = "position_mm = [-400.0, -230.0,"
IN_DRAWINGS = (
    drawn(_FRAME, "[0.0, 0.0, 1.0]", "[0.0, 0.0, -1.0]", "outward_axis = [0.0, 0.0, -1.0]"),
    drawn(_DECK, "[0.0, 0.0, 1.0]", "[0.0, 0.0, -1.0]", "outward_axis"),
    drawn(_DECK, "diameter_mm = 6.0", "diameter_mm = 3.0", "diameter_mm = 3: 6, give or take 0.1"),
    drawn(_DECK, 'kind = "pin"', 'kind = "thread"', "kind = 'thread': as hole P1"),
    drawn(_DECK, "diameter_mm = 5.0", "diameter_mm = 3.0", "4 to 8.25 for one screw; hole P2"),
    drawn(_BOTH, "diameter_mm = 6.0", "diameter_mm = 60.0", "0.5 to 50 mm"),
    drawn(_BOTH, "diameter_mm = 6.0", "diameter_mm = 0.006", "0.5 to 50 mm"),
    drawn(("frame.toml", "deck.toml"), _P3, _P3.replace("-400.0", "400.0"), "a place in view"),
    drawn(("frame.toml", "deck.toml"), _P3, _P3.replace("-230.0", "230.0"), "a place in view"),
    drawn(_BOTH, "[400.0, 230.0,", "[-400.0, -230.0,", "another place than that of"),
    drawn(_DECK, f"{_P3} -2.5]", f"{_P3} 25.0]", "z from -15 up to -1.4"),
    drawn(_DECK, "position_sigma_mm = 0.004", "position_sigma_mm = 0.4", "at most 0.041"),
    drawn(_DECK, '["P1", "P2", "P3"]', '["P1", "P1", "P2"]', "head_1 lists P1 twice"),
    drawn(_DECK, '["P1", "P2", "P3"]', '["P1", "P2", "P4"]', "without P4, which head_2 sees"),
)
"""Mistakes in the feature files of the fake cell."""
