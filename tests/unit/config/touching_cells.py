"""Mistakes of somebody who set up the cells that plug a module and that insert by touch."""

from collections.abc import Iterator

from tests.unit.config.mistake import Mistake, Undecided

_ANTENNA = "antenna.toml"
_INSERTION = "insertion-connector.toml"
_TOUCHING = (_ANTENNA, _INSERTION)
_RANGE = "force_sensors.force.settings.range"
_SIX = "range = [200.0, 200.0, 200.0, 10.0, 10.0, 10.0]"


def _sensors() -> Iterator[Mistake]:
    moments = _SIX.replace("10.0", "10000.0")
    for file in _TOUCHING:
        yield Mistake(file, _SIX, moments, _RANGE, "or were the moments in N·mm?")
        for limit, least in (("190.0", "at least 211.2 N"), ("199.0", "at least 221.2 N")):
            yield Mistake(
                file,
                "free_force_n = 60.0",
                f"free_force_n = {limit}",
                _RANGE,
                least,
                at_the_other=True,
            )
        yield Mistake(
            file,
            "free_moment_n_m = 8.0",
            "free_moment_n_m = 9.9",
            _RANGE,
            "at least 11 N·m",
            at_the_other=True,
        )
    tenfold = "range = [2000.0, 2000.0, 2000.0, 100.0, 100.0, 100.0]"
    yield Mistake(_ANTENNA, _SIX, tenfold, _RANGE, "forces of at most 1000 N")


def _places() -> Iterator[Mistake]:
    """Places that the taught poses over them contradict, named at the pose."""
    plug = "flange_T_plug = [0.0, 0.0, 200.0, 0.0, 0.0, 0.0]"
    marks = "flange_T_marks = [0.0, 0.0, 200.0, 0.0, 0.0, 0.0]"
    socket = "pose = [500.0, -200.0, 200.0, 180.0, 0.0, 0.0]"
    tray = "pose = [450.0, 300.0, 160.0, 0.0, 0.0, 180.0]"
    tip = "flange_T_tip = [0.0, 0.0, 200.0, 0.0, 0.0, 0.0]"
    hole = "pose = [500.0, -200.0, 200.0, 0.0, 0.0, 0.0]"
    for file, pose, old, new, said in (
        (_ANTENNA, "tray", plug, plug.replace("200.0", "212.0"), "here the tool is 48 mm over"),
        (_ANTENNA, "tray", plug, plug.replace("200.0", "188.0"), "here the tool is 72 mm over"),
        (_ANTENNA, "socket", plug, plug.replace("200.0, 0", "200.0, 180"), "turned by 180 deg"),
        (_ANTENNA, "socket", plug, plug.replace("200.0, 0", "200.0, 90"), "turned by 90 deg"),
        (
            _ANTENNA,
            "tray",
            f"{plug}\n{marks}",
            f"{plug}\n{marks}".replace("200.0", "250.0"),
            "here the tool is 10 mm over",
        ),
        (_ANTENNA, "socket", socket, socket.replace(" 200.0", " 208.0"), "is 2 mm over"),
        (_ANTENNA, "socket", socket, socket.replace(" 200.0", " 220.0"), "is -10 mm over"),
        (_ANTENNA, "socket", socket, socket.replace(" 200.0", " 180.0"), "is 30 mm over"),
        (_ANTENNA, "socket", socket, socket.replace("180.0", "0.0"), "turned by 180 deg"),
        (_ANTENNA, "socket", socket, socket.replace("180.0", "90.0"), "turned by 90 deg"),
        (_ANTENNA, "socket", socket, socket.replace("180.0, 0", "180.0, 5"), "turned by 5 deg"),
        (_ANTENNA, "tray", tray, tray.replace("160.0", "180.0"), "is 40 mm over"),
        (_ANTENNA, "tray", tray, tray.replace("160.0", "140.0"), "is 80 mm over"),
        (_ANTENNA, "tray", tray, tray.replace("160.0, 0", "160.0, 180"), "turned by 180 deg"),
        (_INSERTION, "hole", tip, tip.replace("200.0", "212.0"), "is 3 mm over"),
        (_INSERTION, "hole", tip, tip.replace("200.0", "188.0"), "is 27 mm over"),
        (_INSERTION, "hole", tip, tip.replace("200.0, 0.0, 0", "200.0, 0.0, 5"), "by 5 deg"),
        (_INSERTION, "hole", hole, hole.replace(" 200.0", " 212.0"), "is 3 mm over"),
        (_INSERTION, "hole", hole, hole.replace(" 200.0", " 180.0"), "is 35 mm over"),
        (_INSERTION, "hole", hole, hole.replace("200.0, 0.0, 0", "200.0, 0.0, 5"), "by 5 deg"),
        (_INSERTION, "hole", hole, hole.replace("500.0", "520.0"), "20 mm beside it"),
    ):
        key = f"robots.arm.poses_deg.above_{pose}"
        yield Mistake(file, old, new, key, said, at_the_other=True)
    for radians in ("3.14159", "1.5708"):
        written = socket.replace("180.0", radians)
        yield Mistake(_ANTENNA, socket, written, "recipes.0.base_T_socket.pose", "radians")
    metres = "pose = [0.45, 0.3, 0.16, 0.0, 0.0, 180.0]"
    yield Mistake(_ANTENNA, tray, metres, "recipes.0.base_T_tray_plug.pose", "metres")


def _figures() -> Iterator[Mistake]:
    """Figures of an insertion by touch."""
    forces, place = "recipes.0.forces", "recipes.0.base_T_hole"
    yield Mistake(
        _INSERTION, "search_n = 10.0", "search_n = 80.0", f"{forces}.search_n", "half of insertion"
    )
    for depth in ("0.0", "0.012", "1.2"):
        yield Mistake(
            _INSERTION,
            "datum_depth_mm = 12.0",
            f"datum_depth_mm = {depth}",
            f"{place}.datum_depth_mm",
            "stands proud of that",
        )
    yield Mistake(
        _INSERTION,
        "window_deg = 1.0,",
        "window_deg = 0.01745,",
        "recipes.0.fit.keys.window_deg",
        "or is it in radians?",
    )
    contacts = "contacts = { depth_mm = 6.0, full_mm = 6.5, least_n = 25.0, most_n = 40.0 }"
    for old, new, key, said in (
        ("6.0", "60.0", "depth_mm", "contacts begin after the peg has entered"),
        ("40.0", "400.0", "most_n", "never passed"),
        ("6.5", "65.0", "full_mm", "0.8 mm before the seat"),
        ("6.5", "0.65", "full_mm", "after they have begun"),
        ("25.0", "250.0", "least_n", "at most most_n = 40"),
        ("25.0", "2.5", "least_n", "a part that slides in freely"),
    ):
        where = f"recipes.0.fit.contacts.{key}"
        yield Mistake(_INSERTION, contacts, contacts.replace(old, new), where, said)


TOUCHING_CELLS = (*_sensors(), *_places(), *_figures())

MEANT_PERHAPS = (
    Undecided(
        Mistake(
            _INSERTION,
            "keys = { depth_mm = 3.0, window_deg = 1.0, uncertainty_deg = 1.8 }",
            "",
            "recipes.0.fit.keys",
            "seldom is round all over",
        ),
        "a raised plug without keys: it may have none",
    ),
    Undecided(
        Mistake(
            _ANTENNA,
            "flange_T_marks = [0.0, 0.0, 200.0, 0.0,",
            "flange_T_marks = [0.0, 0.0, 200.0, 180.0,",
            "recipes.0.flange_T_marks",
            "turned by 180 deg against the plug",
        ),
        "marks that are turned against the plug: they may be drawn from the other side",
    ),
    Undecided(
        Mistake(
            _ANTENNA,
            "taught_above_mm = 60.0",
            "",
            "recipes.0.base_T_tray_plug.taught_above_mm",
            "before contact",
        ),
        "a height over the tray that nobody measured",
    ),
    Undecided(
        Mistake(
            _INSERTION,
            "taught_above_mm = 15.0",
            "",
            "recipes.0.base_T_hole.taught_above_mm",
            "before contact",
        ),
        "a height over the hole that nobody measured",
    ),
    Undecided(
        Mistake(
            _ANTENNA,
            "above_socket = ",
            "over_socket = ",
            "robots.arm.poses_deg",
            "nothing holds flange_T_plug",
        ),
        "no pose over the socket: none of the moves needs it",
    ),
)
