"""Holds limits of a recipe against its drawings, and the drawings against each other."""

from collections.abc import Iterator
from math import atan2, degrees, hypot, isclose
from pathlib import Path

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import Bound, bound_issues
from cellctl.config.checks.plausible.loads import G_M_S2
from cellctl.config.checks.plausible.sensors import NOISE_SHARE
from cellctl.config.driver_settings import measuring_range
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.drawings import read_drawings
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import FORCE
from cellctl.processes.antenna_module.settings import ReferenceSection

_MOST_PER_CONTACT_N = 7.0
"""Twice what makers of D-subs to DIN 41652 state: 50 N for 15 contacts. Micro-Ds to MIL-DTL-83513
take 2.78 N a contact."""
_SIGMAS = 20.0
"""A force that is compared with thresholds of a few standard deviations lies well above them."""
_OPEN_SHARE = 0.25
"""Of the way from the first touch of the springs to the seat, which a module that is called good
may lack: three quarters of it are left to hold. For a micro-D 0.5 mm, twice what the defaults take.
"""
_PITCHES = (1.6, 4.5)
"""Distance of neighbouring contacts over the diameter of a pin. Micro-Ds (MIL-DTL-83513) have 2.5,
nano-Ds (MIL-DTL-32139) 2.1, D-subs (DIN 41652) 2.8, circular connectors (MIL-DTL-38999) 2.9 to 3.1,
headers 3.2 to 4."""
_SPREADS = 3.0
"""Standard deviations of both contacts of a pair within which a good plug finds its socket."""
_OVER_CONTACTS = 4.0
"""Sides of an insulator over what its contacts span; micro-Ds have 1.3 along and 2.5 across."""
_MASS_RATIO = 0.2
"""Modules of one drawing differ by a few percent: solder, screws, a label."""


def contact_bounds(recipe: AntennaRecipe, key: str, socket: Connector) -> Iterator[Bound]:
    """Offsets at which a pin no longer finds its hole."""
    capture_mm = socket.capture_m / MM
    why = "capture_mm of the socket's drawing: farther off a pin meets the face beside its hole"
    for name in ("worst_contact_mm", "seated_limit_mm"):
        yield Bound(f"{key}.{name}", float(getattr(recipe, name)), why, most=capture_mm)
    farthest_mm = float(np.linalg.norm(socket.positions_m, axis=1).max()) / MM
    why = (
        f"more moves the contact that is {farthest_mm:.2f} mm from the middle by more than "
        f"capture_mm of the socket's drawing, {capture_mm:g}"
    )
    most_deg = degrees(atan2(capture_mm, farthest_mm))
    yield Bound(f"{key}.seated_limit_deg", recipe.seated_limit_deg, why, most=most_deg)


def holding_bounds(recipe: AntennaRecipe, key: str, socket: Connector) -> Iterator[Bound]:
    """How far a plug may be from its drawn seat, and how hard it may be pulled, and still hold."""
    insertion, way_mm = recipe.insertion, _way_mm(socket)
    open_mm = _OPEN_SHARE * way_mm
    why = (
        f"{_OPEN_SHARE:g} of the {way_mm:g} mm from spring_depth_mm to seat_depth_mm of the "
        "socket's drawing is what a plug that holds may lack"
    )
    yield Bound(
        f"{key}.insertion.seat_tolerance_mm", insertion.seat_tolerance_mm, why, most=open_mm
    )
    yield Bound(f"{key}.gap_limit_mm", recipe.gap_limit_mm, why, most=open_mm)
    # A module may have been short of its seat by the one and have come up by the other.
    why = f"{why}, seat_tolerance_mm of the insertion included"
    left_mm = open_mm - insertion.seat_tolerance_mm
    yield Bound(f"{key}.gap_limit_mm", recipe.gap_limit_mm, why, most=left_mm)
    why = (
        "the least force_n of the socket's drawing: a plug that goes in with so little is held by "
        "no more, and a pull beyond it draws good modules out"
    )
    yield Bound(f"{key}.insertion.pull_n", insertion.pull_n, why, most=socket.force_n[0])


def capture_remarks(recipe: AntennaRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """An offset at which no pin finds its hole by its funnel, and two drawings that say two."""
    drawings = read_drawings(recipe, folder)
    plug, socket = drawings.plug, drawings.socket
    found_mm = (socket.diameter_m / 2 + socket.funnel_m - plug.diameter_m / 2 + plug.chamfer_m) / MM
    capture_mm = socket.capture_m / MM
    if capture_mm > found_mm:
        said = (
            f"a pin of {plug.diameter_m / MM:g} mm with its chamfer of {plug.chamfer_m / MM:g} mm "
            f"meets the funnel of funnel_mm = {socket.funnel_m / MM:g} over a bore of "
            f"{socket.diameter_m / MM:g} mm up to {found_mm:.2g} mm beside its middle, if that "
            "narrows by 45 deg. Farther off it stands on the face, and how far off the plug may "
            "be, and what it may press with before the springs, follows from capture_mm"
        )
        yield ConfigIssue(f"{key}.socket", f"capture_mm = {capture_mm:g} in it", said)
    if not isclose(plug.capture_m, socket.capture_m):
        said = (
            f"the drawing of the socket has capture_mm = {capture_mm:g}, and that counts; both say "
            "how far off one plug still finds one socket"
        )
        yield ConfigIssue(f"{key}.plug", f"capture_mm = {plug.capture_m / MM:g} in it", said)


def spread_issues(recipe: AntennaRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """Contacts that are good by their drawings and do not find their holes."""
    drawings = read_drawings(recipe, folder)
    plug_mm, socket_mm = (one.true_position_m / MM for one in (drawings.plug, drawings.socket))
    capture_mm, spread_mm = drawings.socket.capture_m / MM, hypot(plug_mm, socket_mm)
    if _SPREADS * spread_mm > capture_mm:
        allowed = (
            f"standard deviations of which {_SPREADS:g} of a pair, here {_SPREADS * spread_mm:.2g} "
            f"mm, are less than capture_mm = {capture_mm:g} of the socket: a contact that is bent "
            "so far would be called good, and would stand on the face"
        )
        against = (
            WrittenValue(f"{key}.socket", f"{recipe.socket!r}, true_position_mm = {socket_mm:g}"),
        )
        value = f"{recipe.plug!r}, true_position_mm = {plug_mm:g}"
        yield ConfigIssue(f"{key}.plug", value, allowed, against=against)


def outline_remarks(recipe: AntennaRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """Insulators that are far larger than what they hold: further contacts are looked for there,
    and the lever of a force is believed as far out."""
    drawings = read_drawings(recipe, folder)
    for name, connector in (("plug", drawings.plug), ("socket", drawings.socket)):
        spans_m = np.ptp(connector.positions_m, axis=0) + connector.diameter_m
        times = float((np.array(connector.outline_m) / spans_m).max())
        if times > _OVER_CONTACTS:
            outline_mm = [round(side_m / MM, 3) for side_m in connector.outline_m]
            said = (
                f"{times:.2g} times as wide as its contacts with what they span; right if the "
                "insulator is so large"
            )
            yield ConfigIssue(f"{key}.{name}", f"outline_mm = {outline_mm} in it", said)


def pitch_remarks(recipe: AntennaRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """Pins that are far thinner or thicker for their distance than those of any usual connector."""
    plug = read_drawings(recipe, folder).plug
    pitch_mm, wide_mm = plug.least_spacing_m / MM, plug.diameter_m / MM
    if not _PITCHES[0] <= pitch_mm / wide_mm <= _PITCHES[1]:
        said = (
            f"its contacts are {pitch_mm:.3g} mm apart, {pitch_mm / wide_mm:.2g} times as far as "
            f"its pins are wide, and those of usual connectors {_PITCHES[0]:g} to {_PITCHES[1]:g} "
            "times: is it the radius, here and in the socket? Right if the connector has such pins"
        )
        yield ConfigIssue(f"{key}.plug", f"diameter_mm = {wide_mm:g} in it", said)


def holding_remarks(recipe: AntennaRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    """A pull that may take the plug along, and a weighing that takes another module for this."""
    travel_mm = recipe.insertion.pull_travel_mm
    open_mm = _OPEN_SHARE * _way_mm(read_drawings(recipe, folder).socket)
    if travel_mm > open_mm:
        said = (
            f"a plug that comes along with the arm is drawn farther than the {open_mm:g} mm by "
            "which one that holds may be short of its seat; right if arm and fingers give way so "
            "far"
        )
        yield ConfigIssue(f"{key}.insertion.pull_travel_mm", f"{travel_mm:g}", said)
    ratio = recipe.mass_tolerance_ratio
    if ratio > _MASS_RATIO:
        said = (
            f"modules of {recipe.module_mass_kg * (1 - ratio):.3g} to "
            f"{recipe.module_mass_kg * (1 + ratio):.3g} kg pass for this one, whose like differ by "
            "a few percent; right if hoses or cables pull at it while it is weighed"
        )
        yield ConfigIssue(f"{key}.mass_tolerance_ratio", f"{ratio:g}", said)


def _way_mm(socket: Connector) -> float:
    """How far a pin goes from where the springs begin to its seat."""
    return (socket.seat_depth_m - socket.spring_depth_m) / MM


def one_file_twice(
    recipe: AntennaRecipe, key: str, reference: ReferenceSection | None, where: str
) -> Iterator[ConfigIssue]:
    """One drawing for two things that are not the same."""
    if recipe.gripper_marks == recipe.module_top:
        allowed = "the marks on top of the module; gripper_marks names this file, too"
        yield ConfigIssue(f"{key}.module_top", repr(recipe.module_top), allowed)
    if reference is not None and reference.plate_above == reference.plate_below:
        allowed = "the dots as camera II sees them; plate_above names this file, too"
        yield ConfigIssue(f"{where}.reference.plate_below", repr(reference.plate_below), allowed)


def force_issues(
    cell: CellConfig, recipe: AntennaRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Forces of a plugging that no such contacts take, that the sensor does not measure, or that
    the drawings of plug and socket have otherwise."""
    drawings = read_drawings(recipe, folder)
    found = [
        *bound_issues([_force_bound(cell, recipe, f"{key}.plug", drawings.plug)]),
        *bound_issues([_force_bound(cell, recipe, f"{key}.socket", drawings.socket)]),
    ]
    yield from found
    plug_n, socket_n = list(drawings.plug.force_n), list(drawings.socket.force_n)
    if plug_n != socket_n and not found:
        allowed = f"force_n as in {recipe.socket}, {socket_n}: one connection has one force"
        against = (WrittenValue(f"{key}.socket", f"{recipe.socket!r}, force_n = {socket_n}"),)
        value = f"{recipe.plug!r}, force_n = {plug_n}"
        yield ConfigIssue(f"{key}.plug", value, allowed, against=against)


def pull_issues(cell: CellConfig, recipe: AntennaRecipe, key: str) -> Iterator[ConfigIssue]:
    """A sensor so strong that the pull of the test would be lost in its noise, or whose range is
    written too high."""
    name, pull_n = recipe.device(FORCE), recipe.insertion.pull_n
    measuring = measuring_range(cell.force_sensors[name])
    if not measuring:
        return
    most_n = pull_n / (_SIGMAS * NOISE_SHARE)
    if min(measuring[:3]) > most_n:
        allowed = (
            f"forces of at most {most_n:.0f} N: {NOISE_SHARE:g} of the range is a sensor's noise, "
            f"and insertion.pull_n is to be {_SIGMAS:g} times as much; with a range that the "
            "sensor does not have, a clipped force is taken for a true one"
        )
        against = (WrittenValue(f"{key}.insertion.pull_n", f"{pull_n:g}"),)
        where = f"force_sensors.{name}.settings.range"
        yield ConfigIssue(where, str(measuring), allowed, against=against)


def _force_bound(cell: CellConfig, recipe: AntennaRecipe, key: str, connector: Connector) -> Bound:
    name, count = recipe.device(FORCE), len(connector.contacts)
    most_n = _MOST_PER_CONTACT_N * count
    why = (
        f"greatest force_n of {connector.name}, {_MOST_PER_CONTACT_N:g} N for each of its {count} "
        "contacts: a pin that stubs would be pushed with what all of them take"
    )
    measuring = measuring_range(cell.force_sensors[name])
    if measuring:
        clips_n = min(measuring[:3]) - recipe.module_mass_kg * G_M_S2
        if clips_n < most_n:
            most_n = clips_n
            why = (
                f"greatest force_n of {connector.name}, the range of force_sensors.{name} less the "
                "weight of the module: more is neither measured nor stopped at"
            )
    return Bound(key, connector.force_n[1], why, most=most_n)
