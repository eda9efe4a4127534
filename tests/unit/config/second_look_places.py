"""Mistakes that somebody else tried than the author of the checks: a second look at places.

Each is a slip of a usual sort: a factor of ten, a sign, two figures or two poses exchanged.
"""

from tests.unit.config.mistake import deck, deck_elsewhere

PLACES = (
    deck_elsewhere(
        "home = [0.0, -90.0, 90.0, 0.0, 90.0, 90.0]",
        "home = [0.0, -52.76637, 109.14017, 0.0, 33.6262, 90.0]",
        "robots.main.poses_deg.deck_measure",
        "another place than home",
    ),
    deck_elsewhere(
        "measuring = [-3.29612, -67.1374, 90.69669, 0.0, 66.4407, -93.29612]",
        "measuring = [-6.91545, -98.67699, 111.2808, 0.0, 77.39619, -96.91545]",
        "robots.aux_1.poses_deg.retracted",
        "another place than measuring",
    ),
    deck(
        "deck_measure = [0.0, -52.76637, 109.14017, 0.0, 33.6262, 90.0]",
        "deck_measure = [60.0, -52.76637, 109.14017, 0.0, 33.6262, 90.0]",
        "robots.main.poses_deg.deck_measure",
        "teach the pose again",
    ),
    deck(
        "deck_measure = [0.0, -52.76637, 109.14017, 0.0, 33.6262, 90.0]",
        "deck_measure = [0.0, -90.0, 90.0, 0.0, 90.0, 90.0]",
        "robots.main.poses_deg.deck_measure",
        "another place than home",
    ),
    deck(
        "flange_T_deck = [0.0, 0.0, 502.0, 0.0, 0.0, 180.0]",
        "flange_T_deck = [0.0, 0.0, 502.0, 0.0, 0.0, 0.0]",
        "recipes.0.flange_T_deck",
        "did you mean [0.0, 0.0, 502.0, 0.0, 0.0, 180.0]? ",
    ),
    deck(
        "flange_T_deck = [0.0, 0.0, 502.0",
        "flange_T_deck = [0.0, 0.0, -502.0",
        "recipes.0.flange_T_deck",
        "did you mean [0.0, 0.0, 502.0, 0.0, 0.0, 180.0]? ",
    ),
    deck(
        "flange_T_deck = [0.0, 0.0, 502.0",
        "flange_T_deck = [0.0, 0.0, 50.2",
        "recipes.0.flange_T_deck",
        "did you mean [0.0, 0.0, 502.0, 0.0, 0.0, 180.0]? ",
    ),
    deck(
        "flange_T_camera = [-89.5, 0.0, 120.0, 0.0, 10.0, 0.0]",
        "flange_T_camera = [-89.5, 0.0, 120.0, 0.0, 170.0, 0.0]",
        "stereo_cameras.head_1.flange_T_camera",
        "looks away from the arm",
    ),
    deck(
        "flange_T_sensor = [0.0, 0.0, 60.0, 0.0, 0.0, 0.0]",
        "flange_T_sensor = [0.0, 0.0, 6000.0, 0.0, 0.0, 0.0]",
        "force_sensors.force.flange_T_sensor",
        "within 3000 mm",
    ),
    deck(
        "joints_max_deg = [90.0, 20.0, 144.0, 180.0, 120.0, 210.0]",
        "joints_max_deg = [900.0, 200.0, 1440.0, 1800.0, 1200.0, 2100.0]",
        "robots.main.settings.joints_max_deg",
        "-360 to 360",
    ),
    deck(
        "workspace_max_mm = [2500.0, 900.0, 2400.0]",
        "workspace_max_mm = [25000.0, 9000.0, 24000.0]",
        "robots.main.settings.workspace_max_mm",
        "as far as the arm reaches",
    ),
    deck_elsewhere(
        "dh = [[0.0, 1045.0, 500.0, -90.0], [0.0, 0.0, 1300.0, 0.0]",
        "dh = [[0.0, 1045.0, 500.0, 90.0], [0.0, 0.0, 1300.0, 0.0]",
        "robots.main.poses_deg.home",
        "the flange comes to",
    ),
    deck_elsewhere(
        "dh = [[0.0, 1045.0, 500.0, -90.0], [0.0, 0.0, 1300.0, 0.0]",
        "dh = [[0.0, 500.0, 1045.0, -90.0], [0.0, 0.0, 1300.0, 0.0]",
        "robots.main.d1_mm",
        "500, as the first link",
    ),
    deck_elsewhere(
        'carried_by = "aux_1"',
        'carried_by = "aux_2" # ',
        "stereo_cameras.head_2.carried_by",
        "carries head_1",
    ),
    deck(
        'mounted_on = "main"',
        'mounted_on = "aux_1"',
        "force_sensors.force.mounted_on",
        "carries the deck",
    ),
    deck(
        "[zones.beside_head_2.robots]\nmain = { min_mm = [800.0, 60.0",
        "[zones.beside_head_2.robots]\nmain = { min_mm = [800.0, -300.0",
        "zones.beside_head_2.robots.main",
        "both must stand there at once",
    ),
    deck_elsewhere(
        "aux_1 = { min_mm = [1450.0, -800.0, 600.0]",
        "aux_2 = { min_mm = [1450.0, -800.0, 600.0]",
        "zones.beside_head_1.retreat",
        "a robot of this zone",
    ),
    deck(
        "base_frame_joints_deg = [0.0, -78.0, 120.0, 0.0, 45.0, 90.0]",
        "base_frame_joints_deg = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
        "processes.deck-to-frame.base_frame_joints_deg",
        "turns A1 and A2",
    ),
    deck(
        "flange_T_target_board = [23.3, 30.0, 622.6",
        "flange_T_target_board = [23.3, 30.0, 6226.0",
        "processes.deck-to-frame.flange_T_target_board",
        "within 3000 mm",
    ),
    deck(
        "base_T_frame = [1900.0, 0.0, 400.0, 90.0, 0.0, 0.0]",
        "base_T_frame = [1900.0, 0.0, 400.0, 0.0, 90.0, 0.0]",
        "recipes.0.base_T_frame",
        "outside the box",
    ),
    deck(
        "base_T_frame = [1900.0, 0.0, 400.0, 90.0, 0.0, 0.0]",
        "base_T_frame = [1900.0, 500.0, 400.0, 90.0, 0.0, 0.0]",
        "recipes.0.base_T_frame",
        "y 0 mm of the frame",
    ),
    deck(
        "base_T_frame = [1900.0, 0.0, 400.0, 90.0, 0.0, 0.0]",
        "base_T_frame = [1900.0, 0.0, 400.0, -90.0, 0.0, 0.0]",
        "recipes.0.base_T_frame",
        "turned by 180 deg",
    ),
)
"""Poses, frames, mountings, zones and the kinematics behind them."""
