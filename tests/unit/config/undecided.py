"""Edits that no check can call wrong, each with its reason."""

from tests.unit.config.between_arms import LOW_BOX, UNLIKE_BOX
from tests.unit.config.mistake import Mistake, Undecided, deck, drawn

_BOTH = ("deck.toml", "frame.toml")


def _real(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("cell.toml", f"{old}", new, key, said)


_LOAD = """[robots.main.load]          # with the deck, as a person has selected it on the controller
mass_kg = 200.0
com_mm = [30.0, 20.0, 460.0]
tolerance_kg = 12.0         # procedure 106 weighs in a narrow cone, where cross-talk of 1 % moves the weight by 1.5 %
tolerance_mm = 30.0
"""  # noqa: E501
_RANGE = "range = [5000.0, 5000.0, 5000.0, 1000.0, 1000.0, 1000.0]"
_WEIGHED = (
    Undecided(
        deck(_LOAD, "", "robots.main.load", "nothing is compared with what procedure 106 weighs"),
        "no load: a cell need not compare it",
    ),
    Undecided(
        deck(
            "tolerance_kg = 12.0",
            "tolerance_kg = 50.0",
            "robots.main.load.tolerance_kg",
            "more than 16 kg, 8% of the mass",
        ),
        "a wide tolerance of the load: parts of one job may differ so much",
    ),
    Undecided(
        deck(
            _RANGE,
            _RANGE.replace("000.0", "0000.0"),
            "force_sensors.force.settings.range",
            "50000 N for a weight of 1962 N",
        ),
        "a far larger sensor: somebody may have had one",
    ),
    Undecided(
        deck(
            'mounted_on = "main"',
            'mounted_on = "main"\nfree_force_n = 200.0',
            "force_sensors.force.free_force_n",
            "200 kg took 1500 N on a fake arm",
        ),
        "a low limit of free moves: the controller may start its joint moves gently",
    ),
    Undecided(
        drawn(
            ("deck.toml",),
            "position_sigma_mm = 0.004",
            "position_sigma_mm = 0.0004",
            "no gauge tells them better than 0.0013 mm",
        ),
        "holes made more exactly than anybody can measure: nothing here contradicts it",
    ),
)

UNDECIDED = (
    *_WEIGHED,
    Undecided(UNLIKE_BOX, "a smaller box than that of the other head: its surroundings may differ"),
    Undecided(LOW_BOX, "a box that reaches below the arm's feet: it may stand on a pedestal"),
    Undecided(
        deck(
            "max_iterations = 10",
            'max_iterations = 10\nmethod = "paper"',
            "recipes.0.pose_correction.method",
            "for comparison",
        ),
        "the paper's method: a comparison may be meant",
    ),
    Undecided(
        deck(
            "target_force_n = 35.0",
            "target_force_n = 35.0\nmax_past_contact_mm = 2.0",
            "recipes.0.mating.max_past_contact_mm",
            "would press with 2000 N",
        ),
        "a longer way past the contact: a soft joint may need it",
    ),
    Undecided(
        deck(
            "target_force_n = 35.0",
            "target_force_n = 35.0\ncontact_window_mm = 3.0",
            "recipes.0.mating.contact_window_mm",
            "something between",
        ),
        "a wide window of contact: thick seals exist",
    ),
    Undecided(
        Mistake(
            "insertion-pin.toml",
            "grip_n = 60.0",
            "",
            "recipes.0.seat.grip_n",
            "measure at which force",
        ),
        "no grip force: it is measured at commissioning",
    ),
    Undecided(
        drawn(
            _BOTH,
            "position_mm = [-400.0, -230.0,",
            "position_mm = [-480.0, -230.0,",
            "lie on one line",
        ),
        "three holes of a head on a line: the pose follows from all six",
    ),
    Undecided(
        deck('board = "9x6"', 'board = "10x7"', "processes.deck-to-frame.board", "made with 9x6"),
        "another board than the calibration's: it may be a new one",
    ),
    Undecided(
        Mistake(
            "insertion-connector.toml",
            "flange_T_sensor = [0.0, 0.0, 30.0, 0.0,",
            "flange_T_sensor = [0.0, 0.0, 30.0, 90.0,",
            "force_sensors.force.flange_T_sensor",
            "",
        ),
        "a sensor turned about its axis, where no load is weighed: only a push by hand shows it",
    ),
    Undecided(
        deck(
            "com_mm = [30.0, 20.0, 460.0]",
            "com_mm = [30.0, 20.0, 390.0]",
            "robots.main.load",
            "payload differs",
        ),
        "a load that differs from the weighed one: the gripper may be new",
    ),
    Undecided(
        _real(
            '"192.168.20.22", port = 7102',
            '"192.168.20.21", port = 7102',
            "stereo_cameras.head_2.settings.host",
            "one server serves both",
        ),
        "two heads at one address: one server may serve both",
    ),
    Undecided(
        _real(
            'robot_address = "192.168.20.12"',
            'robot_address = "192.168.2.12"',
            "robots.aux_1.settings.robot_address",
            "not in 192.168.20.0/24",
        ),
        "a controller in another network: it may be routed, or the network wider",
    ),
    Undecided(
        _real('data_dir = "/var/lib/cellctl"', 'data_dir = "runs"', "data_dir", "relative to"),
        "a relative data_dir: started by hand it is found",
    ),
    Undecided(
        _real('host = "192.168.10.1"', 'host = "0.0.0.0"', "plc.host", "every network"),
        "the line at every address of this PC: allowed_clients lets in who is listed",
    ),
    Undecided(
        deck("over_travel_mm = 10.0", "over_travel_mm = 1.0", "recipes.0.over_travel_mm", ""),
        "a hard end of travel of 1 mm: it is never a target, and behind every target that is",
    ),
    Undecided(
        deck(
            "command_port = 7001\nstate_port = 7002",
            "command_port = 7002\nstate_port = 7001",
            "robots.main.settings.command_port",
            "",
        ),
        "two ports of one controller exchanged: which program listens where only --connect finds",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "module_mass_kg = 0.25",
            "module_mass_kg = 2.5",
            "recipes.0.module_mass_kg",
            "",
        ),
        "another mass of a module: it is weighed when it was picked, and refused then",
    ),
    Undecided(
        Mistake(
            "insertion-pin.toml",
            "clearance_mm = 0.05",
            "clearance_mm = 0.3",
            "recipes.0.fit.clearance_mm",
            "wider than the fits of parts of this size",
        ),
        "a wider clearance: such parts exist, and the seat is judged by force",
    ),
    Undecided(
        Mistake(
            "insertion-pin.toml",
            'calibration_dir = "insertion-pin-calibration"\n',
            'calibration_dir = "none"\n',
            "processes.peg-in-hole.stiffness_n_mm",
            "",
        ),
        "a cell whose loop was not measured yet: the bounds of its file count",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "open_valve = 0\nclose_valve = 1",
            "open_valve = 1\nclose_valve = 0",
            "grippers.gripper.settings.close_valve",
            "closes when it is to open",
        ),
        "valves exchanged against the sensors: they may be wired so",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "opened_sensor = 0\nclosed_sensor = 1",
            "opened_sensor = 1\nclosed_sensor = 0",
            "grippers.gripper.settings.close_valve",
            "closes when it is to open",
        ),
        "sensors exchanged against the valves: they may be wired so",
    ),
    Undecided(
        deck(
            "measuring = [-3.29612, -67.1374",
            "measuring = [-3.29612, -77.1374",
            "robots.aux_1.poses_deg.measuring",
            "was measured at [-3.29612, -67.1374",
        ),
        "a measuring pose 10 degrees off from which the holes are seen: taught again perhaps",
    ),
    Undecided(
        deck('data_dir = "runs/cell"', 'data_dir = "demo-calibration"', "data_dir", ""),
        "one folder for runs and calibrations: their files have different names",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "inspect_plug = [11.30993,",
            "inspect_plug = [-11.30993,",
            "robots.arm.poses_deg.inspect_plug",
            "by the stored base_T_cam2 not over the place that was measured",
        ),
        "the plug beside where camera II was measured: the camera may have been moved since",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "flange_T_camera = [110.0, 0.0, -50.0,",
            "flange_T_camera = [110.0, 0.0, 50.0,",
            "cameras.camera_1.flange_T_camera",
            "100 mm and 0 deg away from where the stored flange_T_cam1 has this camera",
        ),
        "camera I beside where it was measured: it may be mounted otherwise now",
    ),
    Undecided(
        Mistake(
            "antenna.toml",
            "base_T_plate = { pose = [500.0,",
            "base_T_plate = { pose = [510.0,",
            "processes.antenna-module.reference.base_T_plate.pose",
            "where the stored reference has the plate",
        ),
        "the plate beside where it was measured: it may have been moved since",
    ),
)
"""``said`` of a mistake is part of the remark that `cellctl check` makes, where it makes one.

Besides these: with neither a model of the cell nor stored calibrations nothing says where heads
stand, so that arms, heads or lists of holes exchanged with each other remain unseen.
"""
