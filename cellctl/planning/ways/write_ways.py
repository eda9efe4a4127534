"""Writes planned ways into a cell file, whose comments and order stay."""

from collections.abc import Sequence
from typing import Any

import tomlkit

from cellctl.config.devices import WayConfig
from cellctl.planning.ways.plan_ways import PlannedWay


def with_ways_written(text: str, ways: Sequence[PlannedWay]) -> str:
    """The text of a cell file with these ways in place of all that it had."""
    document = tomlkit.parse(text)
    robots: Any = document["robots"]
    for name, robot in robots.items():
        robot.pop("ways", None)
        tables = [_table(way, one) for way in ways if way.robot == name for one in way.written()]
        if tables:
            robot["ways"] = tomlkit.aot()
            for table in tables:
                robot["ways"].append(table)
    return tomlkit.dumps(document)


def _table(way: PlannedWay, written: WayConfig) -> Any:
    table = tomlkit.table()
    table.add(tomlkit.comment(f"planned: {way.time_s:.1f} s; narrowest: {way.narrowest}"))
    table.add("start", written.start)
    table.add("end", written.end)
    points = tomlkit.array()
    for joints_deg in written.via_deg:
        points.add_line(list(joints_deg))
    points.add_line(indent="")
    table.add("via_deg", points)
    return table
