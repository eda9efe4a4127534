"""Mistakes of a first week: what stands in a shipped cell file, and what somebody wrote instead."""

from tests.unit.config.mistake import Mistake, deck, deck_elsewhere


def _antenna(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("antenna.toml", old, new, key, said)


def _pin(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("insertion-pin.toml", old, new, key, said)


def _gige(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("deck-gige.toml", old, new, key, said)


_HOME = "home = [0.0, -90.0, 90.0, 0.0, 90.0, 90.0]"
_HEAD_2 = "stereo_cameras.head_2.settings"
_STOP = "force_sensors.force.stop_channel.settings"
_MAIN = "robots.main.settings"
_DH_1 = "dh = [[0.0, 1045.0, 500.0, -90.0]"

SPELLING = (
    deck(
        "speed_percent = 40", "speed_precent = 40", "robots.main.speed_precent", "'speed_percent'"
    ),
    deck("stale_ms = 300.0", "stale_s = 0.3", "force_sensors.force.stale_s", "'stale_ms'"),
    deck("\nboard = ", "\nbord = ", "processes.deck-to-frame.bord", "'board'"),
    deck("stand_off_mm", "standoff_mm", "recipes.0.standoff_mm", "'stand_off_mm'"),
    deck("silence_s", "silense_s", f"{_MAIN}.silense_s", "'silence_s'"),
    deck("rate_hz = ", "rate_Hz = ", "force_sensors.force.settings.rate_Hz", "'rate_hz'"),
    deck("[plc]", "[pcl]", "pcl", "'plc'"),
    deck('"target-server"', '"target_server"', "trackers.tracker.driver", "'target-server'"),
    deck('driver = "sri"', 'driver = "SRI"', "force_sensors.force.driver", "installed: sri"),
    deck('= "aux_2"', '= "aux2"', "stereo_cameras.head_2.carried_by", "'aux_2'"),
    deck('mounted_on = "main"', 'mounted_on = "mian"', "force_sensors.force.mounted_on", "'main'"),
    deck('"deck-to-frame"', '"deck-to-fram"', "recipes.0.process", "'deck-to-frame'"),
    _gige(
        "serial_number",
        "serial_nummer",
        f"{_HEAD_2[:-10]}1.settings.left.serial_nummer",
        "'serial_number'",
    ),
)
"""Keys, drivers and names of devices."""

TYPES = (
    deck("speed_percent = 40", 'speed_percent = "40"', "robots.main.speed_percent", "integer"),
    deck("port = 5020", 'port = "5020"', "plc.port", "integer"),
    deck("port = 5020", "port = 70000", "plc.port", "0 to 65535"),
    deck("simulated = true", 'simulated = "true"', "robots.main.simulated", "boolean"),
    deck("speed_percent = 40", "speed_percent = 140", "robots.main.speed_percent", "1 to 100"),
    deck("command_port = 7001", "command_port = 7001.5", f"{_MAIN}.command_port", "integer"),
    deck(
        "max_iterations = 10",
        "max_iterations = true",
        "recipes.0.pose_correction.max_iterations",
        "integer",
    ),
    deck(
        "heartbeat_timeout_s = 3.0",
        "heartbeat_timeout_s = 3000",
        "plc.heartbeat_timeout_s",
        "0.5 to 10",
    ),
    deck(_HOME, "home = [0.0, -90.0, 90.0, 0.0, 90.0]", "robots.main.poses_deg.home", "here are 5"),
    _antenna('name = "', "name = 7 # ", "name", "a text"),
)
"""Numbers in quotes, beyond their range, of the wrong kind."""

UNITS = (
    deck(
        _HOME,
        "home = [0.0, -1.5708, 1.5708, 0.0, 1.5708, 1.5708]",
        "robots.main.poses_deg.home",
        "radians",
    ),
    deck(
        "joints_min_deg = [-90.0, -130.0, 20.0, -180.0, -30.0, -30.0]",
        "joints_min_deg = [-1.57, -2.27, 0.35, -3.14, -0.52, -0.52]",
        f"{_MAIN}.joints_min_deg",
        "radians",
    ),
    deck(
        "base_T_frame = [1900.0, 0.0, 400.0, 90.0",
        "base_T_frame = [1.9, 0.0, 0.4, 90.0",
        "recipes.0.base_T_frame",
        "metres",
    ),
    deck("400.0, 90.0, 0.0, 0.0]", "400.0, 1.5708, 0.0, 0.0]", "recipes.0.base_T_frame", "radians"),
    deck(
        "[0.0, 0.0, 60.0, 0.0",
        "[0.0, 0.0, 0.06, 0.0",
        "force_sensors.force.flange_T_sensor",
        "metres",
    ),
    deck(
        "flange_T_camera = [-89.5, 0.0, 120.0",
        "flange_T_camera = [-0.0895, 0.0, 0.12",
        "stereo_cameras.head_1.flange_T_camera",
        "metres",
    ),
    deck(
        "workspace_min_mm = [900.0, -900.0, 880.0]",
        "workspace_min_mm = [0.9, -0.9, 0.88]",
        f"{_MAIN}.workspace_min_mm",
        "metres",
    ),
    deck(
        "min_mm = [800.0, -1500.0, 300.0]",
        "min_mm = [0.8, -1.5, 0.3]",
        "zones.beside_head_1.robots.main.min_mm",
        "metres",
    ),
    deck("a1_mm = 500.0", "a1_mm = 0.5", "robots.main.a1_mm", "metres"),
    deck(_DH_1, "dh = [[0.0, 1045.0, 500.0, -1.5708]", f"{_MAIN}.dh", "radians"),
    deck("max_deadman_s = 1.5 ", "max_deadman_s = 500 ", f"{_MAIN}.max_deadman_s", "milliseconds"),
    deck("silence_s = 1.5", "silence_s = 500.0", f"{_MAIN}.silence_s", "milliseconds"),
    deck(
        "linear_speed_mm_s = 50.0",
        "linear_speed_mm_s = 0.05",
        "robots.main.linear_speed_mm_s",
        "1 to 500",
    ),
    deck("d1_mm = 1045.0", "d1_mm = 1.045", "robots.main.d1_mm", "100 to 3000"),
    _antenna(
        "workspace_min_mm = [",
        "workspace_min_mm = [0.25, -0.35, 0.34] # [",
        "robots.arm.settings.workspace_min_mm",
        "metres",
    ),
)
"""Radians, metres and milliseconds."""

ADDRESSES = (
    _gige('"192.168.10.1"', '"192.168.10.256"', "plc.host", "0 to 255"),
    _gige('"192.168.0.108"', '"192.168.0.1080"', "force_sensors.force.settings.host", "0 to 255"),
    _gige(
        'host = "192.168.20.23"',
        'host = "192.168.20"',
        "trackers.tracker.settings.host",
        "four numbers",
    ),
    _gige(
        'host = "192.168.20.23"',
        'host = "192.168.20.12"',
        "trackers.tracker.settings.host",
        "controller of robots.aux_1",
    ),
    deck(
        "command_port = 7011",
        "command_port = 7001",
        "robots.aux_1.settings.command_port",
        "robots.main.settings.command_port",
    ),
    deck(
        "state_port = 7022",
        "state_port = 7012",
        "robots.aux_2.settings.state_port",
        "robots.aux_1.settings.state_port",
    ),
    deck_elsewhere(
        "state_port = 7002", "state_port = 7001", f"{_MAIN}.command_port", "must differ"
    ),
    deck("guard_port = 7003", "guard_port = 7002", f"{_STOP}.guard_port", "state_port"),
    deck("port = 7102", "port = 7101", f"{_HEAD_2}.port", "head_1"),
    deck("port = 4008", "port = 7103", "force_sensors.force.settings.port", "trackers.tracker"),
    deck("command_port = 7001", "command_port = 5020", f"{_MAIN}.command_port", "plc.port"),
    _antenna("port = 7312", "port = 7311", "cameras.camera_2.settings.port", "camera_1"),
    _pin("guard_port = 7503", "guard_port = 7501", f"{_STOP}.guard_port", "command_port"),
)
"""Ports and addresses that are none, or that two devices have."""

DEVICES = (
    deck(
        'robot_name = "SR500A", guard',
        'robot_name = "T90A-1", guard',
        f"{_STOP}.robot_name",
        "which it must stop: 'SR500A'",
    ),
    _pin(
        'robot_name = "ARM-1", guard',
        'robot_name = "ARM-2", guard',
        f"{_STOP}.robot_name",
        "which it must stop: 'ARM-1'",
    ),
    deck(
        'robot_name = "T90A-2"',
        'robot_name = "T90A-1"',
        "robots.aux_2.settings.robot_name",
        "two devices",
    ),
    _gige(
        'robot_address = "192.168.20.13"',
        'robot_address = "192.168.20.12"',
        "robots.aux_2.settings.robot_address",
        "two devices",
    ),
    _gige(
        '"192.168.20.11", robot_name',
        '"192.168.20.12", robot_name',
        f"{_STOP}.robot_address",
        "which it must stop",
    ),
    _gige(
        'left.serial_number = "2000001"',
        'left.serial_number = "1000001"',
        f"{_HEAD_2}.left.serial_number",
        "two devices",
    ),
    deck(
        'carried_by = "aux_2"',
        'carried_by = "aux_1"',
        "stereo_cameras.head_2.carried_by",
        "carries head_1",
    ),
    deck(
        'carried_by = "aux_2"',
        'carried_by = "main"',
        "robots.main.poses_deg.measuring",
        "head II",
    ),
    deck("simulated = true", "simulated = false", "simulated", "mark all or none"),
    deck("[trackers.tracker]", "[trackers.head_1]", "trackers.head_1", "must differ"),
)
"""Devices that are taken for one another."""

FIGURES = (
    deck(
        _HOME,
        "home = [95.0, -90.0, 90.0, 0.0, 90.0, 90.0]",
        "robots.main.poses_deg.home",
        "teach the pose again",
    ),
    deck(
        "base_T_frame = [1900.0, 0.0",
        "base_T_frame = [19000.0, 0.0",
        "recipes.0.base_T_frame",
        "outside the box",
    ),
    deck("400.0, 90.0, 0.0, 0.0]", "300.0, 90.0, 0.0, 0.0]", "recipes.0.base_T_frame", "seated"),
    deck(
        'deck_features = "features/deck.toml"',
        'deck_features = "features/frame.toml"',
        "recipes.0.deck_features",
        "as a frame has",
    ),
    deck(
        'frame_features = "features/frame.toml"',
        'frame_features = "features/deck.toml"',
        "recipes.0.frame_features",
        "as a deck has",
    ),
    deck(
        "face_mm = [1000.0, 500.0]", "face_mm = [500.0, 1000.0]", "recipes.0.face_mm", "beside it"
    ),
    deck(
        "speed_percent = 40",
        "speed_percent = 80",
        "robots.main.speed_percent",
        "at most 50",
    ),
    deck(
        "linear_speed_mm_s = 50.0",
        "linear_speed_mm_s = 150.0",
        "robots.main.linear_speed_mm_s",
        "at most 100",
    ),
    deck("d1_mm = 1045.0", "d1_mm = 1054.0", "robots.main.d1_mm", "1045, as the first link"),
    deck("a1_mm = 500.0", "a1_mm = 550.0", "robots.main.a1_mm", "500, as the first link"),
    deck_elsewhere(
        "workspace_max_mm = [2500.0, 900.0, 2400.0]",
        "workspace_max_mm = [2500.0, -950.0, 2400.0]",
        f"{_MAIN}.workspace_min_mm",
        "must lie below workspace_max_mm",
    ),
)
"""Figures against each other."""

MISTAKES = SPELLING + TYPES + UNITS + ADDRESSES + DEVICES + FIGURES
