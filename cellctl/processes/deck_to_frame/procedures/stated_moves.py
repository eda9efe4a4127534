"""The moves of the procedures 101 to 107; 108 makes those of an assembly, 109 some of 103."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.errors.config import ConfigInvalid
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.procedures.base_frame import AxisTurns, turn_angles
from cellctl.procedures.payload import identification_poses
from cellctl.procedures.stereo_head import flange_poses
from cellctl.procedures.stop_latency import TRAVEL_M
from cellctl.processes.deck_to_frame.arms_in_roles import ArmsInRoles
from cellctl.processes.deck_to_frame.roles import HOME, MEASURING, RETRACTED
from cellctl.processes.deck_to_frame.settings import DeckSettings


def procedure_moves(arms: ArmsInRoles) -> Iterator[StatedMove]:
    """Each begins with the main arm at home and the heads retracted, but the one that measures."""
    settings = cast(DeckSettings, arms.cell.processes[arms.recipe.process])
    by_procedures: list[tuple[set[int], Iterable[StatedMove]]] = [
        ({101, 102}, _head_views(arms, settings.stereo_views)),
        ({103, 109}, _axis_turns(arms, settings)),
        ({106}, _tilts(arms, settings)),
        ({107}, _stop_latency(arms)),
    ]
    for numbers, moves in by_procedures:
        yield from (replace(move, procedures=frozenset(numbers)) for move in moves)


def _head_views(arms: ArmsInRoles, count: int) -> Iterator[StatedMove]:
    """101, 102: one head about the board."""
    for name, robot in arms.heads.items():
        others = {arms.main: (arms.taught(arms.main, HOME),)}
        others |= {
            other: (arms.taught(other, RETRACTED),)
            for other in arms.heads.values()
            if other != robot
        }
        measuring = arms.taught(robot, MEASURING)
        written = arms.cell.stereo_cameras[name].flange_T_camera
        if written is None:
            raise ConfigInvalid(f"stereo_cameras.{name}.flange_T_camera is missing")
        flange_T_head = pose_from_xyzabc(written)
        poses = flange_poses(arms.flange_at(robot, measuring), flange_T_head, count)
        views = [
            arms.at_flange(f"view {number}", pose, measuring)
            for number, pose in enumerate(poses[1:], start=2)
        ]
        places = [measuring, *views, measuring]
        for start, end in pairwise(places):
            yield StatedMove(robot, MoveKind.LINEAR, start, end, others)


def _axis_turns(arms: ArmsInRoles, settings: DeckSettings) -> Iterator[StatedMove]:
    """103: A1 alone, then A2 alone, and home from any place of both arcs after an abort."""
    robot, others = arms.main, arms.heads_at(RETRACTED)
    home = arms.taught(robot, HOME)
    start_rad = np.radians(settings.base_frame_joints_deg)
    middle = StatedPlace("middle of both arcs", start_rad)
    turns = AxisTurns(start_rad, settings.circle_arc_deg, settings.circle_stops, 1.0, 1)
    yield StatedMove(robot, MoveKind.JOINT, home, middle, others)
    yield StatedMove(robot, MoveKind.JOINT, middle, home, others)
    for axis in (0, 1):
        stops = turn_angles(turns, axis)
        first, last = (
            StatedPlace(f"{end} of A{axis + 1}'s arc", joints_rad)
            for end, joints_rad in (("beginning", stops[0]), ("end", stops[-1]))
        )
        yield StatedMove(robot, MoveKind.JOINT, middle, first, others)
        yield StatedMove(robot, MoveKind.JOINT, first, last, others)
        yield StatedMove(robot, MoveKind.JOINT, last, middle, others)
        yield StatedMove(robot, MoveKind.JOINT, first, home, others)
        yield StatedMove(robot, MoveKind.JOINT, last, home, others)


def _tilts(arms: ArmsInRoles, settings: DeckSettings) -> Iterator[StatedMove]:
    """106: about the flange at home."""
    robot, others = arms.main, arms.heads_at(RETRACTED)
    home = arms.taught(robot, HOME)
    at_home = arms.flange_at(robot, home)
    poses = identification_poses(at_home, settings.payload_poses, settings.payload_cone_deg)
    here = home
    for number, pose in enumerate(poses, start=1):
        tilted = arms.at_flange(f"tilt {number}", pose.base_T_flange, home)
        yield StatedMove(robot, MoveKind.LINEAR, here, tilted, others)
        yield StatedMove(robot, MoveKind.JOINT, tilted, home, others)
        here = tilted


def _stop_latency(arms: ArmsInRoles) -> Iterator[StatedMove]:
    """107: up from home and back."""
    robot, others = arms.main, arms.heads_at(RETRACTED)
    home = arms.taught(robot, HOME)
    up = RigidTransform.from_translation([0.0, 0.0, TRAVEL_M])
    top = arms.at_flange("above home", up * arms.flange_at(robot, home), home)
    yield StatedMove(robot, MoveKind.LINEAR, home, top, others)
    yield StatedMove(robot, MoveKind.LINEAR, top, home, others)
    yield StatedMove(robot, MoveKind.JOINT, top, home, others)
