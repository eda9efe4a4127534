"""Whether zones hold the main arm off the heads that measure over its station.

A run brings main arm and heads together on purpose, straight over the frame. What a zone is for is
beside the station: there procedure 103 swings the main arm, which comes home from there after an
abort as well, and a head that was left at its measuring pose stands in the way.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.zones import taught_in_zone
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.config.zones import ZoneConfig, ZoneShare
from cellctl.geometry.box import Box
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2, HOME, MAIN, MEASURING
from cellctl.processes.deck_to_frame.settings import DeckSettings

_SIDES = (-1.0, 1.0)
_ROOM_MM = 100.0
"""What every box has beyond the places that are meant (docs/commissioning.md, "Zones", 3): an arm
goes on after a stop, and another one may come as near as the box allows."""


@dataclass(frozen=True, slots=True, eq=False)
class _Station:
    """The arms of a recipe over their station."""

    cell: CellConfig
    main: str
    middle_m: Array
    """Middle of the frame, x and y in the base of the main arm, shape (2,)."""
    turns_m: Array
    """Places of the main arm's flange beside the station, shape (n, 3); none without kinematics."""
    bases: Mapping[str, Sequence[float]]

    def head_m(self, carrier: str) -> Array | None:
        """The flange of a head's arm at its measuring pose, in the base of the main arm."""
        own_m = _measuring_m(self.cell, carrier)
        if own_m is None or not {self.main, carrier} <= self.bases.keys():
            return None
        main_T_other = pose_from_xyzabc(self.bases[self.main]).inv() * pose_from_xyzabc(
            self.bases[carrier]
        )
        return np.asarray(main_T_other.apply(own_m))


def shared_zone_issues(
    cell: CellConfig,
    recipe: DeckRecipe,
    settings: DeckSettings,
    bases: Mapping[str, Sequence[float]],
) -> Iterator[ConfigIssue]:
    """Heads that share no zone with the main arm, or one whose boxes leave a way between.

    ``bases`` holds ``cell_T_base`` in its written form by robot, empty without a model of the cell.
    """
    main = recipe.device(MAIN)
    middle_m = np.array(recipe.base_T_frame[:2]) * MM
    station = _Station(cell, main, middle_m, _turns_m(cell, main, settings), bases)
    for role in (HEAD_1, HEAD_2):
        carrier = cell.stereo_cameras[recipe.device(role)].carried_by or ""
        shared = {
            name: zone
            for name, zone in cell.zones.items()
            if main in zone.robots and carrier in zone.robots
        }
        held = {
            name: zone
            for name, zone in shared.items()
            if MEASURING in taught_in_zone(cell.robots[carrier], _within(zone.robots[carrier]))
        }
        if not shared:
            allowed = (
                f"a zone that names both: procedure 103 swings {main} to where {carrier} stands "
                "while it measures, and nothing else keeps them apart"
            )
            yield ConfigIssue(f"robots.{carrier}", f"in no zone with {main}", allowed)
        elif not held:
            allowed = (
                f"a box that holds its pose {MEASURING}, at which it stands over the station, with "
                f"{_ROOM_MM:g} mm more on every side: the arm goes on after a stop"
            )
            yield _box_issue(shared, carrier, allowed)
        else:
            yield from _left_out(station, carrier, held)


def _within(share: ZoneShare) -> ZoneShare:
    """A share without its room on every side; of a box that has no more than this, the middle."""
    middle = [(low + high) / 2 for low, high in zip(share.min_mm, share.max_mm, strict=True)]
    return share.model_copy(
        update={
            "min_mm": tuple(np.minimum(np.add(share.min_mm, _ROOM_MM), middle).tolist()),
            "max_mm": tuple(np.maximum(np.subtract(share.max_mm, _ROOM_MM), middle).tolist()),
        }
    )


def unlike_box_remarks(cell: CellConfig, recipe: DeckRecipe) -> Iterator[ConfigIssue]:
    """Boxes that differ although their heads measure from one place, each in its arm's own base.

    A box is compared with that one of each arm before it which is most like it: an arm may have
    several, and one head may have none.
    """
    main = recipe.device(MAIN)
    shares: dict[str, dict[str, ZoneShare]] = {}
    for role in (HEAD_1, HEAD_2):
        carrier = cell.stereo_cameras[recipe.device(role)].carried_by
        if carrier is not None:
            shares[carrier] = {
                f"zones.{name}.robots.{carrier}": zone.robots[carrier]
                for name, zone in cell.zones.items()
                if {main, carrier} <= zone.robots.keys()
            }
    for one, other in combinations((arm for arm in shares if shares[arm]), 2):
        places_m = _measuring_m(cell, one), _measuring_m(cell, other)
        if places_m[0] is None or places_m[1] is None:
            continue
        if np.linalg.norm(places_m[0] - places_m[1]) < _ROOM_MM * MM:
            yield from _unlike(shares[one], shares[other])


def _unlike(
    first: Mapping[str, ZoneShare], second: Mapping[str, ZoneShare]
) -> Iterator[ConfigIssue]:
    for key, share in second.items():
        differ_mm = {name: _differ_mm(one, share) for name, one in first.items()}
        like = min(differ_mm, key=lambda name: differ_mm[name])
        if differ_mm[like] > _ROOM_MM:
            said = (
                f"differs by {differ_mm[like]:.0f} mm from {like}, whose head measures from the "
                "same place in the base of its arm: right if other things stand around it"
            )
            yield ConfigIssue(key, f"{list(share.min_mm)} to {list(share.max_mm)}", said)


def _differ_mm(one: ZoneShare, other: ZoneShare) -> float:
    return float(np.max(np.abs(np.subtract(_corners(one), _corners(other)))))


def _corners(share: ZoneShare) -> tuple[float, ...]:
    return (*share.min_mm, *share.max_mm)


def _measuring_m(cell: CellConfig, carrier: str) -> Array | None:
    """The flange of a head's arm at its measuring pose, in its own base."""
    driver, settings = robot_driver(cell.robots[carrier])
    kinematics = driver.forward_kinematics(settings)
    if kinematics is None:
        return None
    joints_rad = np.radians(cell.robots[carrier].poses_deg[MEASURING])
    return np.asarray(kinematics(joints_rad).translation)


def _left_out(
    station: _Station, carrier: str, zones: Mapping[str, ZoneConfig]
) -> Iterator[ConfigIssue]:
    """The first place beside a head to which the main arm turns outside of its boxes."""
    head_m, main = station.head_m(carrier), station.main
    if head_m is None or not len(station.turns_m):
        return
    way_m = head_m[:2] - station.middle_m
    # As far from the station as the head's own flange: from there on the arms are side by side.
    far = (station.turns_m[:, :2] - station.middle_m) @ way_m >= way_m @ way_m
    boxes = [
        Box.from_mm(zone.robots[main].min_mm, zone.robots[main].max_mm) for zone in zones.values()
    ]
    for place_m in station.turns_m[far]:
        if not any(box.holds(place_m) for box in boxes):
            x, y, z = place_m / MM
            allowed = (
                f"a box that holds x {x:.0f}, y {y:.0f}, z {z:.0f} mm, to where procedure 103 and "
                f"the way home from it bring the flange beside {carrier} at its pose {MEASURING} "
                "(by cell_T_base of the model); or the zone is for another arm"
            )
            yield _box_issue(zones, main, allowed)
            return


def _box_issue(zones: Mapping[str, ZoneConfig], robot: str, allowed: str) -> ConfigIssue:
    name, zone = next(iter(zones.items()))
    share = zone.robots[robot]
    value = f"{list(share.min_mm)} to {list(share.max_mm)}"
    return ConfigIssue(f"zones.{name}.robots.{robot}", value, allowed)


def _turns_m(cell: CellConfig, main: str, settings: DeckSettings) -> Array:
    """The flange on the arc of A1 in procedure 103 and on the ways home from both of its ends."""
    driver, driver_settings = robot_driver(cell.robots[main])
    kinematics = driver.forward_kinematics(driver_settings)
    if kinematics is None:
        return np.empty((0, 3))
    middle_rad = np.radians(settings.base_frame_joints_deg)
    home_rad = np.radians(cell.robots[main].poses_deg[HOME])
    half_rad = np.radians(settings.circle_arc_deg / 2.0) * np.eye(6)[0]
    ways_rad = [
        joint_path(start_rad, middle_rad + side * half_rad)
        for side in _SIDES
        for start_rad in (middle_rad, home_rad)
    ]
    return np.array([kinematics(one).translation for one in np.vstack(ways_rad)])
