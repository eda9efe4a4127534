"""The ways home of the shipped deck cells lead out of their zones from wherever a stop leaves an
arm."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from cellctl.cell.zones.ways import joint_way
from cellctl.cell.zones.zone import Share, zones_of
from cellctl.config import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.process_definition import process_definition
from cellctl.config.stated.moves import MoveKind, StatedMove
from cellctl.config.via_points import via_points
from cellctl.geometry.arm.reaching import joints_reaching
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import Array
from cellctl.interfaces.robot import ForwardKinematics
from tests.rigs.shipped import CONFIG, shipped_cell
from tests.unit.cell.robots import StillRobot

CELL = "deck.toml"
HOME = {"main": "home", "aux_1": "retracted", "aux_2": "retracted"}
"""Where each arm goes first after an abort."""
EVERY = 3
"""Of the points of a joint move, 1 degree apart at most, every third is a place where it stops."""
AT_FACE = 6
"""Places between two points on both sides of a face, where ways home are the most oblique."""


def test_the_cells_with_zones_are_alike() -> None:
    """So that the ways home of one of them say all. Without forward kinematics, as in the others,
    no joint move is a way out, and a person jogs."""
    looked_at = shipped_cell(CELL)
    names = [path.name for path in CONFIG.glob("*.toml") if "[zones." in path.read_text("utf-8")]
    assert CELL in names
    for cell in map(shipped_cell, names):
        assert cell.zones.keys() == looked_at.zones.keys()
        for robot in HOME:
            if _kinematics(cell, robot) is not None:
                assert cell.zones == looked_at.zones
                assert cell.processes == looked_at.processes
                assert _moved(cell, robot) == _moved(looked_at, robot)


def test_every_way_home_leads_out() -> None:
    cell = shipped_cell(CELL)
    stops: dict[str, int] = dict.fromkeys(HOME, 0)
    for robot, joints_rad in _stops(cell):
        for share in _shares(cell, robot):
            if share.box.holds(_flange_m(cell, robot, joints_rad)):
                stops[robot] += 1
                assert _leads_home(cell, robot, joints_rad, share), (robot, np.degrees(joints_rad))
    assert all(count > 10 for count in stops.values()), stops


def _moved(cell: CellConfig, robot: str) -> tuple[object, ...]:
    config = cell.robots[robot]
    return config.poses_deg, config.ways, config.settings


def _leads_home(cell: CellConfig, robot: str, joints_rad: Array, share: Share) -> bool:
    """The first leg home from a place leads out of the zone, or the next one from there, and so
    on."""
    config, kinematics = cell.robots[robot], _kinematics(cell, robot)
    assert kinematics is not None
    arm = StillRobot(robot)
    home_rad = np.radians(config.poses_deg[HOME[robot]])
    for target_rad in (*via_points(config, joints_rad, HOME[robot]), home_rad):
        arm.joints_rad, arm.flange = joints_rad, kinematics(joints_rad)
        if not share.box.holds(arm.flange.translation):
            return True
        if not joint_way(arm.state(), target_rad, kinematics).leads_out(share):
            return False
        joints_rad = target_rad
    return True


def _stops(cell: CellConfig) -> Iterator[tuple[str, Array]]:
    """Where a stop may leave an arm of which zones are asked: on its stated joint moves, and at
    the ends of the straight ones."""
    seen: set[bytes] = set()
    for move in _moves(cell):
        for joints_rad in _places(cell, move):
            key = move.robot.encode() + np.round(joints_rad, 5).tobytes()
            if key not in seen:
                seen.add(key)
                yield move.robot, joints_rad


def _moves(cell: CellConfig) -> Iterator[StatedMove]:
    # All recipes of these cells share the arms and the moves past their zones.
    recipe = cell.recipes[0]
    for move in process_definition(recipe.process).moves(cell, recipe, CONFIG):
        if _shares(cell, move.robot):
            yield move


def _places(cell: CellConfig, move: StatedMove) -> Iterator[Array]:
    if move.kind is MoveKind.JOINT and move.start.base_T_flange is None:
        config = cell.robots[move.robot]
        via = via_points(config, move.start.joints_rad, move.end.label)
        legs = pairwise([move.start.joints_rad, *via, move.end.joints_rad])
        way_rad = np.vstack([joint_path(*leg) for leg in legs])
        yield from way_rad[::EVERY]
        for share in _shares(cell, move.robot):
            inside = [share.box.holds(_flange_m(cell, move.robot, one)) for one in way_rad]
            for index in np.flatnonzero(np.diff(inside)):
                yield from np.linspace(way_rad[index], way_rad[index + 1], AT_FACE)
    elif move.end.base_T_flange is not None:
        driver, settings = robot_driver(cell.robots[move.robot])
        chain = driver.chain(settings)
        assert chain is not None
        near_rad = move.end.joints_rad
        there_rad = joints_reaching(chain, move.end.base_T_flange.as_matrix(), near_rad)
        assert there_rad is not None, move.name
        yield there_rad


def _shares(cell: CellConfig, robot: str) -> list[Share]:
    return [zone.shares[robot] for zone in zones_of(cell) if robot in zone.shares]


def _flange_m(cell: CellConfig, robot: str, joints_rad: Array) -> Array:
    kinematics = _kinematics(cell, robot)
    assert kinematics is not None
    return np.asarray(kinematics(joints_rad).translation)


def _kinematics(cell: CellConfig, robot: str) -> ForwardKinematics | None:
    driver, settings = robot_driver(cell.robots[robot])
    return driver.forward_kinematics(settings)
