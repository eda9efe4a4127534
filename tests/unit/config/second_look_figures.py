"""Mistakes that somebody else tried than the author of the checks: a second look at figures.

Each is a slip of a usual sort: a factor of ten, a sign, two figures or two poses exchanged.
"""

from tests.unit.config.mistake import deck, deck_elsewhere

FIGURES = (
    deck_elsewhere(
        "target_force_n = 35.0", "target_force_n = 49.9", "recipes.0.mating", "leave no window"
    ),
    deck(
        "limit_force_n = 50.0",
        "limit_force_n = 500.0",
        "recipes.0.mating.limit_force_n",
        "at most 175",
    ),
    deck(
        "limit_force_n = 50.0",
        "limit_force_n = 5000.0",
        "recipes.0.mating.limit_force_n",
        "10 to 500",
    ),
    deck(
        "deck_thickness_mm = 15.0",
        "deck_thickness_mm = 150.0",
        "recipes.0.deck_thickness_mm",
        "65 mm above the frame",
    ),
    deck(
        "deck_thickness_mm = 15.0",
        "deck_thickness_mm = 1.5",
        "recipes.0.deck_thickness_mm",
        "depth of countersink P2",
    ),
    deck(
        "deck_thickness_mm = 15.0",
        "deck_thickness_mm = 3.0",
        "recipes.0.deck_thickness_mm",
        "15, give or take 0.048: thickness_mm of its features",
    ),
    deck(
        "deck_thickness_mm = 15.0",
        "deck_thickness_mm = 18.0",
        "recipes.0.deck_thickness_mm",
        "15, give or take 0.048: thickness_mm of its features",
    ),
    deck_elsewhere(
        "deck_thickness_sigma_mm = 0.012",
        "deck_thickness_sigma_mm = 0.12",
        "recipes.0.mating",
        "4 sigma",
    ),
    deck(
        "stand_off_mm = 10.0", "stand_off_mm = 1.0", "recipes.0.stand_off_mm", "max_correction_mm"
    ),
    deck(
        "face_mm = [1000.0, 500.0]",
        "face_mm = [10000.0, 5000.0]",
        "recipes.0.face_mm.0",
        "0 to 5000",
    ),
    deck(
        "threshold_deg = 0.006",
        "threshold_deg = 0.5",
        "recipes.0.pose_correction.threshold_deg",
        "seated_limit_deg",
    ),
    deck(
        "threshold_mm = 0.05",
        "threshold_mm = 5.0",
        "recipes.0.pose_correction.threshold_mm",
        "0 to 1",
    ),
    deck(
        "stop_latency_ms = 300.0",
        "stop_latency_ms = 3.0",
        "recipes.0.mating.stop_latency_ms",
        "at least 20",
    ),
    deck(
        "stiffness_n_per_mm = 1000.0",
        "stiffness_n_per_mm = 1.0",
        "recipes.0.mating.stiffness_n_per_mm",
        "10 to 20000",
    ),
    deck(
        "rate_hz = 1000",
        "rate_hz = 10",
        "force_sensors.force.settings.rate_hz",
        "at least 100 samples",
    ),
    deck(
        "range = [5000.0, 5000.0, 5000.0",
        "range = [50.0, 50.0, 50.0",
        "force_sensors.force.settings.range",
        "at least 2222.3 N",
    ),
    deck("stale_ms = 300.0", "stale_ms = 3000.0", "force_sensors.force.stale_ms", "2 to 500"),
    deck(
        "flange_age_ms = 600.0",
        "flange_age_ms = 6.0",
        "force_sensors.force.flange_age_ms",
        "20 to 1000",
    ),
    deck(
        "max_speed_mm_s = 100.0",
        "max_speed_mm_s = 10000.0",
        "robots.main.settings.max_speed_mm_s",
        "0 to 2000",
    ),
    deck(
        "linear_acceleration_mm_s2 = 200.0",
        "linear_acceleration_mm_s2 = 20000.0",
        "robots.main.linear_acceleration_mm_s2",
        "1 to 2000",
    ),
    deck(
        "travel_sigma_mm = 0.01",
        "travel_sigma_mm = 10.0",
        "recipes.0.mating.travel_sigma_mm",
        "0 to 1",
    ),
)
"""Forces, distances, thresholds, rates and speeds."""

OTHERS = (
    deck(
        "square_mm = 25.0",
        "square_mm = 2.5",
        "processes.deck-to-frame.square_mm",
        "corners span 20 mm",
    ),
    deck("square_mm = 25.0", "square_mm = 250.0", "processes.deck-to-frame.square_mm", "0 to 100"),
    deck(
        'board = "9x6"',
        'board = "9*6"',
        "processes.deck-to-frame.board",
        "did you mean '9x6'? a text of the form",
    ),
    deck('board = "9x6"', 'board = "8x8"', "processes.deck-to-frame.board", "turned by 90 deg"),
    deck(
        "stereo_views = 24", "stereo_views = 3", "processes.deck-to-frame.stereo_views", "8 to 100"
    ),
    deck(
        'name = "deck 500 x 1000 on frame"', 'name = ""', "recipes.0.name", "at least 1 character"
    ),
    deck("id = 1\n", "id = 0\n", "recipes.0.id", "1 to 99"),
    deck("id = 1\n", "id = 107\n", "recipes.0.id", "1 to 99"),
    deck_elsewhere(
        'host = "127.0.0.1"\nport = 5020',
        'host = "0.0.0.0"\nport = 502',
        "plc.host",
        "allowed_clients must list",
    ),
    deck('data_dir = "runs/cell"', 'data_dir = ""', "data_dir", "a folder"),
    deck(
        'calibration_dir = "demo-calibration"',
        'calibration_dir = "demo-calibrations"',
        "calibration_dir",
        "'demo-calibration'",
    ),
    deck(
        'frame_features = "features/frame.toml"',
        'frame_features = "features/frames.toml"',
        "recipes.0.frame_features",
        "No such file",
    ),
    deck(
        "silence_s = 1.5",
        "silence_s = 0.01",
        "robots.main.settings.silence_s",
        "at least 0.02 seconds",
    ),
    deck(
        "max_deadman_s = 1.5 ",
        "max_deadman_s = 0.001 ",
        "robots.main.settings.max_deadman_s",
        "at least 0.1 seconds",
    ),
    deck(
        "port = 7101, reply_timeout_s = 60.0",
        "port = 7101, reply_timeout_s = 0.01",
        "stereo_cameras.head_1.settings.reply_timeout_s",
        "at least 0.02 seconds",
    ),
    deck_elsewhere(
        'driver = "siasun-sjl"\nsimulated = true\nlinear_speed_mm_s = 250.0',
        'driver = "siasun-rpc"\nsimulated = true\nlinear_speed_mm_s = 250.0',
        "robots.aux_1.settings.host",
        "needed here: a text",
    ),
    deck(
        'host = "127.0.0.1", port = 7101',
        'host = "localhots", port = 7101',
        "stereo_cameras.head_1.settings.host",
        "'localhost'",
    ),
    deck('name = "fake-cell"', 'name = ""', "name", "at least 1 character"),
)
"""Boards, recipes, folders, addresses and time limits."""
