"""The faults that each device of a scenario knows, told without starting any of them."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Literal

from fakes.faults import JOB_FAULTS, ROBOT_FAULTS, TRACKER_FAULTS
from fakes.scenario_file.scenario import Scenario
from fakes.scenes.registry import scene_class
from fakes.wire.cameras.frame_server_faults import FrameFaults
from fakes.wire.cameras.gentl_faults import GentlFaults
from fakes.wire.couplers.coupler import COUPLER_FAULTS
from fakes.wire.duco.faults import DUCO_FAULTS
from fakes.wire.sri.faults import SriFaults

_OF_CAMERAS: Mapping[str | None, frozenset[str]] = {
    "frame-server": frozenset(FrameFaults.NAMES),
    "gentl": frozenset(GentlFaults.NAMES),
    None: frozenset((*FrameFaults.NAMES, *GentlFaults.NAMES)),
}
_OF_ROBOTS = {"rpc": DUCO_FAULTS, "jobs": JOB_FAULTS}


class UnknownFault(ValueError):
    """No device, or no fault of it, has this name; the text names those that there are."""


def known_faults(
    scenario: Scenario, cameras: Literal["gentl", "frame-server"] | None
) -> dict[str, frozenset[str]]:
    """By device; the bodies are called ``world``. ``cameras``: how images come, None if that is
    not decided."""
    sections: tuple[tuple[Iterable[str], Iterable[str]], ...] = (
        (scenario.force_sensors, [field.name for field in fields(SriFaults)]),
        (scenario.trackers, TRACKER_FAULTS),
        (scenario.all_cameras(), _OF_CAMERAS[cameras]),
        ((*scenario.grippers, *scenario.digital_ios), COUPLER_FAULTS),
        (("world",), scene_class(scenario.scene).fault_texts),
    )
    robots = {
        name: frozenset(_OF_ROBOTS.get(robot.controller, ROBOT_FAULTS))
        for name, robot in scenario.robots.items()
    }
    return robots | {name: frozenset(known) for names, known in sections for name in names}


def require_known(item: str, known: Mapping[str, frozenset[str]]) -> None:
    """Raises ``UnknownFault`` for what is no ``device:name`` of these devices."""
    device, colon, name = item.partition(":")
    if not colon or device not in known:
        raise UnknownFault(f"{item!r} is no device:name; the devices are {', '.join(known)}")
    if name not in known[device]:
        there = ", ".join(sorted(known[device])) or "none"
        raise UnknownFault(f"{device} knows no fault {name!r}; it knows {there}")
