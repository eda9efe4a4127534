"""Denavit-Hartenberg tables that no arm has, and tables of arms of one type that differ.

A figure that is wrong by less passes here. Drivers hold the table against the pose that the
controller reports when they connect, before anything moves.
"""

from collections.abc import Iterator, Set
from itertools import combinations

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.pose import MM, Array

_OFF_DEG = 1.0
"""Greatest angle between the axes of a real arm and those of its drawing; calibrated tables have a
few hundredths of a degree."""
_SAME_MM, _SAME_DEG = 0.01, 0.001
_OFFSET_MM = 3.0
"""Calibrated tables have less than this where the drawing has nothing."""
_ROLLING_WRIST = (90.0, 0.0, 90.0, 90.0, 90.0, 0.0)
"""Twists, without their signs, of an arm whose forearm turns about itself."""
_REACH_SHARE = 0.02
"""Published reaches of one arm differ from list to list by up to 1.5 %."""
_BESIDE = ((3, 2), (4, 1), (4, 2), (5, 2))
"""Rows and columns of the lengths that move its last three axes out of one point."""
_COLUMNS = ("offset", "d", "a", "alpha")
_FLANGE = (5, 1)
"""Row and column of the length from wrist to flange, which an adapter makes longer."""


def table_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Axes that are neither parallel nor square to each other, and two arms of one type.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    chains = described_arms(cell, bad)
    slanted = set()
    for name, chain in chains.items():
        for row, column in ((row, column) for row in range(6) for column in (0, 3)):
            angle_deg = float(np.degrees(chain.dh[row, column]))
            if abs((angle_deg + 45.0) % 90.0 - 45.0) > _OFF_DEG:
                slanted.add(name)
                allowed = (
                    f"a multiple of 90 deg, within {_OFF_DEG:g} deg: axes of arms are parallel or "
                    "square to each other"
                )
                yield ConfigIssue(_key(name), _written(chain.dh, row, column), allowed)
    for (name, one), (other, two) in combinations(chains.items(), 2):
        differs = _different(one.dh, two.dh)
        if len(differs) == 1 and differs[0] != _FLANGE and not slanted & {name, other}:
            row, column = differs[0]
            against = (WrittenValue(_key(name), _written(one.dh, row, column)),)
            allowed = f"as robots.{name} has it, whose table is the same but for this figure"
            value = _written(two.dh, row, column)
            yield ConfigIssue(_key(other), value, allowed, against=against)


def table_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Axes of a wrist that do not meet, arms beside their own first axis, one longer flange."""
    chains = described_arms(cell, frozenset())
    for name, chain in chains.items():
        yield from _unusual(name, chain.dh)
        yield from _reach(cell, name, chain.dh)
    for (name, one), (other, two) in combinations(chains.items(), 2):
        if _different(one.dh, two.dh) == [_FLANGE]:
            said = f"otherwise the table of robots.{name}; right if this flange has an adapter"
            yield ConfigIssue(_key(other), _written(two.dh, *_FLANGE), said)


def described_arms(cell: CellConfig, bad: Set[str]) -> dict[str, ArmChain]:
    """The arms whose settings describe their links, by name."""
    found = {}
    for name, robot in cell.robots.items():
        if f"robots.{name}" not in bad:
            driver, settings = robot_driver(robot)
            chain = driver.chain(settings)
            if chain is not None:
                found[name] = chain
    return found


def _unusual(name: str, dh: Array) -> Iterator[ConfigIssue]:
    if not _has_rolling_wrist(dh):
        return  # an arm of another make, such as a collaborative one with its wrist beside itself
    for row, column in _BESIDE:
        if abs(dh[row, column]) > _OFFSET_MM * MM:
            said = (
                "the axes A4, A5 and A6 of nearly all arms like this one meet in one point, where "
                "this length is 0"
            )
            yield ConfigIssue(_key(name), _written(dh, row, column), said)
    beside_m = float(dh[1, 1] + dh[2, 1])
    if abs(beside_m) > _OFFSET_MM * MM:
        said = "so far the forearm of this arm is beside its axis A1; nearly all arms have 0 here"
        yield ConfigIssue(_key(name), f"d of A2 and A3: {beside_m / MM:g} mm", said)


def _reach(cell: CellConfig, name: str, dh: Array) -> Iterator[ConfigIssue]:
    """A table whose stretched arm is longer or shorter than its maker's."""
    driver, settings = robot_driver(cell.robots[name])
    published_m = driver.published_reach_m(settings)
    if published_m is None or not _has_rolling_wrist(dh):
        return
    reach_m = float(abs(dh[0, 2]) + abs(dh[1, 2]) + np.hypot(dh[2, 2], dh[3, 1]))
    if abs(reach_m - published_m) > _REACH_SHARE * published_m:
        said = (
            f"from A1 to the wrist this arm would reach {reach_m / MM:.0f} mm, and arms of this "
            f"model {published_m / MM:.0f} mm: the table of another arm, or another model"
        )
        value = f"a of A1 to A3, d of A4: {reach_m / MM:.0f} mm together"
        yield ConfigIssue(_key(name), value, said)


def _has_rolling_wrist(dh: Array) -> bool:
    twists_deg = np.abs(np.degrees(dh[:, 3]))
    return bool(np.max(np.abs(twists_deg - _ROLLING_WRIST)) <= _OFF_DEG)


def _different(one: Array, two: Array) -> list[tuple[int, int]]:
    """Rows and columns of the figures in which two tables differ."""
    between = one - two
    turns = between[:, [0, 3]]
    between[:, [0, 3]] = np.arctan2(np.sin(turns), np.cos(turns))
    same = np.array([np.radians(_SAME_DEG), _SAME_MM * MM, _SAME_MM * MM, np.radians(_SAME_DEG)])
    return [(int(row), int(column)) for row, column in np.argwhere(np.abs(between) > same)]


def _key(name: str) -> str:
    return f"robots.{name}.settings.dh"


def _written(dh: Array, row: int, column: int) -> str:
    """One figure of a table as the cell file has it."""
    value = dh[row, column]
    text = f"{value / MM:g} mm" if column in (1, 2) else f"{np.degrees(value):g} deg"
    return f"{_COLUMNS[column]} of A{row + 1}: {text}"
