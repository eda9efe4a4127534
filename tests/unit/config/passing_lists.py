"""Slips in the figures of lists that `cellctl check` lets pass, each kind with its reason.

Lists are taught poses and joints, tables of links, boxes, mounted poses. The first kind that has
the slip decides it.
"""

from tests.unit.config.passing_slips import Kind

_ANY = "0 1 2 3 4 5"


def _at(path: str, places: str, slips: str) -> tuple[str, ...]:
    """Patterns of these slips at these places of a list, counted from 0."""
    return tuple(f"{path}[[]{place}] {slip}" for place in places.split() for slip in slips.split())


def _near(path: str, places: str = _ANY) -> tuple[str, ...]:
    """Ten more and ten less."""
    return _at(path, places, "+10 -10")


_FLANGE = "robots.*.settings.workspace_m??_mm"
_JOINT = "robots.*.settings.joint_workspace_m??_mm"
_LEAST, _MOST = "robots.*.settings.joints_min_deg", "robots.*.settings.joints_max_deg"

LISTS = (
    Kind(
        "a way back that is not the way there: `cellctl check --moves` holds both against the "
        "model of the cell",
        (*_near("robots.*.ways.via_deg"), *_at("robots.*.ways.via_deg", "4 5", "/10")),
        remarked=True,
    ),
    Kind(
        "the same angle, written otherwise",
        (
            *_at("robots.*.settings.dh", "20", "sign"),
            *_at("recipes.flange_T_deck", "5", "sign"),
            *_at("recipes.plug_T_top", "5", "sign"),
            *_at("recipes.base_T_tray_plug.pose", "5", "sign"),
            *_at("recipes.base_T_socket.pose", "3", "sign"),
        ),
    ),
    Kind(
        "a box that leads into the arm's own column or far below its work",
        (
            *_at("robots.*.settings.workspace_min_mm", "0 2", "/10 sign"),
            *_at("robots.*.settings.joint_workspace_min_mm", "0", "/10 sign"),
            *_at("robots.*.settings.joint_workspace_min_mm", "2", "sign"),
        ),
        remarked=True,
    ),
    Kind(
        "a box that is narrower, and that holds all that the arm has to reach",
        (*_at("robots.*.settings.workspace_m??_mm", "1", "/10"),),
    ),
    Kind(
        "a box for joint moves that is lower by less than a fifth of the reach: tables and floors "
        "are in the model of the cell, against which --moves holds the ways",
        _at("robots.*.settings.joint_workspace_min_mm", "2", "/10"),
    ),
    Kind(
        "a box that is 10 mm wider or narrower: as good, as long as it holds what is needed",
        (*_near(_FLANGE, "0 1 2"), *_near(_JOINT, "0 1 2")),
    ),
    Kind(
        "joint limits far beyond all stated joints",
        (
            *_at("robots.arm.settings.joints_min_deg", "2", "sign"),
            *_at(_LEAST, "4 5", "x10"),
            *_at(_MOST, "1 5", "x10"),
        ),
        remarked=True,
    ),
    Kind(
        "narrower joint limits, which hold all stated joints",
        (
            *_at(_LEAST, "0 3", "/10"),
            *_at("robots.main.settings.joints_min_deg", "4 5", "/10 sign"),
            *_at("robots.aux_?.settings.joints_min_deg", "4", "/10 sign"),
            *_at(_MOST, "0 3 5", "/10"),
            *_at("robots.aux_?.settings.joints_max_deg", "5", "sign"),
            *_at("robots.arm.settings.joints_max_deg", "5", "sign"),
            *_at("robots.main.settings.joints_max_deg", "1", "/10 sign"),
            *_at("robots.aux_?.settings.joints_max_deg", "1", "/10 sign"),
        ),
    ),
    Kind(
        "joint limits that are wider by less than a third of a turn: an arm that is folded "
        "otherwise is refused on each straight way (F318), joint moves go to stated joints, and "
        "the controller has limits of its own",
        (
            *_at(_LEAST, "2", "/10 sign"),
            *_at("robots.arm.settings.joints_min_deg", "3 4", "/10 sign"),
            *_at("robots.arm.settings.joints_max_deg", "1", "/10 sign"),
            *_near(_LEAST),
            *_near(_MOST),
        ),
    ),
    Kind(
        "a table whose wrist axes do not meet, or whose forearm is beside A1",
        _near("robots.*.settings.dh", "5 9 14 17 18 22"),
        remarked=True,
    ),
    Kind(
        "a longer flange than that of the other arm of its type",
        _near("robots.aux_?.settings.dh", "21"),
        remarked=True,
    ),
    Kind(
        "a length of a table: the flange would be 5 mm or more from where the controller reports "
        "it, and the driver refuses that when it connects, before any move (F204)",
        (
            *_near("robots.*.settings.dh", "1 2 6 10 13 21"),
            *_at("robots.*.settings.dh", "2 10", "/10"),
        ),
    ),
    Kind(
        "a place that is clear of everything: which places are only the cell shows, and --moves "
        "holds the ways against its model",
        (
            *_near("robots.*.poses_deg.home"),
            *_at("robots.*.poses_deg.home", "4 5", "/10"),
            *_near("robots.aux_?.poses_deg.retracted"),
            *_at("robots.aux_?.poses_deg.retracted", "0 4 5", "/10"),
            *_at("robots.aux_?.poses_deg.retracted", "0", "sign"),
        ),
    ),
    Kind(
        "a measuring pose that is not that of the stored board transfer",
        (
            *_near("robots.aux_?.poses_deg.measuring"),
            *_at("robots.aux_?.poses_deg.measuring", "5", "/10"),
        ),
        remarked=True,
    ),
    Kind(
        "beside what the stored cameras measured",
        (
            *_near("robots.arm.poses_deg.inspect_plug", "0 1 2"),
            *_at("robots.arm.poses_deg.inspect_plug", "4", "+10"),
            *_at("robots.arm.poses_deg.inspect_plug", "0", "/10 sign"),
            *_near("robots.arm.poses_deg.board_look", "0 1 2"),
            *_at("robots.arm.poses_deg.board_look", "4", "+10 /10"),
            *_at("robots.arm.poses_deg.board_look", "5", "/10"),
            *_at("robots.arm.poses_deg.board_look", "0", "sign"),
            *_near("robots.arm.poses_deg.board_show", "0 1 2 4"),
            *_at("robots.arm.poses_deg.board_show", "0", "/10 sign"),
            *_at("robots.arm.poses_deg.board_show", "4", "/10"),
            *_near("cameras.camera_1.flange_T_camera"),
            *_at("cameras.camera_1.flange_T_camera", "2", "/10 sign"),
            *_near("processes.antenna-module.reference.base_T_plate.pose", "0 1"),
            *_at("recipes.flange_T_plug", "4", "-10"),
            *_at("recipes.flange_T_plug", "5", "+10"),
        ),
        remarked=True,
    ),
    Kind(
        "a look that is turned about its own axis, or by at most 10 deg or 50 mm beside its place: "
        "the features are still in the picture, and what is measured there counts",
        (
            *_near("robots.arm.poses_deg.*_look", "0 3 4 5"),
            *_at("robots.arm.poses_deg.board_look", "0", "/10"),
            *_near("robots.arm.poses_deg.inspect_plug", "3 4 5"),
            *_near("robots.arm.poses_deg.board_show", "3 5"),
            *_at("robots.arm.poses_deg.inspect_plug", "5", "/10"),
            *_at("robots.arm.poses_deg.board_show", "5", "/10"),
            *_near("processes.antenna-module.reference.base_T_plate.pose", "2 3 4 5"),
        ),
    ),
    Kind(
        "a place or a mounting by its drawing, off by 10 mm or 10 deg: only what is measured shows "
        "it, and places are measured or touched before anything is pressed",
        (
            *_near("recipes.flange_T_*"),
            *_near("recipes.base_T_*"),
            *_near("recipes.plug_T_top"),
            *_near("recipes.face_mm", "0 1"),
            *_at("recipes.plug_T_top", "2", "/10"),
            *_at("recipes.base_T_socket.pose", "3", "/10"),
            *_at("recipes.flange_T_marks", "2", "/10"),
            *_near("stereo_cameras.head_?.flange_T_camera"),
            *_at("stereo_cameras.head_?.flange_T_camera", "0", "/10"),
        ),
    ),
    Kind(
        "a sensor that does not lie flat on its flange",
        _near("force_sensors.force.flange_T_sensor", "4 5"),
        remarked=True,
    ),
    Kind(
        "a load that differs from the one that was weighed",
        _at("robots.main.load.com_mm", "0 1", "x10"),
        remarked=True,
    ),
    Kind(
        "a load that differs from the weighed one by less than its tolerance",
        (
            *_near("robots.main.load.com_mm", "0 1 2"),
            *_at("robots.main.load.com_mm", "0 1", "/10"),
        ),
    ),
    Kind(
        "where a sensor is in the flange: only a weighing in several attitudes shows it",
        (
            *_near("force_sensors.force.flange_T_sensor", "0 1 2 3"),
            *_at("force_sensors.force.flange_T_sensor", "2", "/10"),
        ),
        remarked=None,
    ),
    Kind(
        "another sensor's data sheet",
        _near("force_sensors.force.settings.range"),
    ),
    Kind(
        "a centre of mass that only a weighing shows; the tare takes it at the attitude of the "
        "insertion",
        (
            *_near("recipes.load.com_in_sensor_mm", "0 1 2"),
            *_at("recipes.load.com_in_sensor_mm", "1 2", "/10"),
            *_at("recipes.load.com_in_sensor_mm", "1", "x10 sign"),
        ),
    ),
    Kind(
        "views of the board nearer to the middle of the picture, or all over it",
        (
            *_near("processes.antenna-module.shift_mm", "0 1"),
            *_at("processes.antenna-module.shift_mm", "0 1", "/10"),
        ),
    ),
    Kind(
        "a zone is drawn about what stands there; a larger one keeps an arm out longer",
        (
            *_near("zones.*.robots.*.m??_mm", "0 1 2"),
            *_at("zones.*.robots.*.min_mm", "0 2", "/10 sign"),
            *_at("zones.*.robots.*.max_mm", "1 2", "x10"),
            *_at("zones.beside_head_?.robots.aux_?.min_mm", "1", "x10"),
            *_at("zones.beside_head_1.robots.main.min_mm", "1", "x10"),
            *_at("zones.beside_head_1.robots.main.max_mm", "1", "/10"),
            *_at("zones.beside_head_2.robots.main.min_mm", "1", "/10"),
        ),
        remarked=None,
    ),
    Kind(
        "a zone that is narrower on a side of a head's arm to which that arm never comes",
        _at("zones.*.robots.aux_?.max_mm", "1", "/10"),
        remarked=True,
    ),
    Kind(
        "where the target board hangs: its targets are looked for in all of the picture",
        (
            *_near("processes.deck-to-frame.flange_T_target_board"),
            *_at("processes.deck-to-frame.flange_T_target_board", "0 1 5", "/10 sign"),
        ),
    ),
    Kind(
        "another middle of the arcs of procedure 103, at which the targets are in view",
        (
            *_near("processes.deck-to-frame.base_frame_joints_deg"),
            *_at("processes.deck-to-frame.base_frame_joints_deg", "5", "/10"),
        ),
    ),
)
