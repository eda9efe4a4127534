"""What is wrong with each device of a cell, in words; empty where nothing is known to be."""

from collections.abc import Callable, Iterable, Mapping

from cellctl.cell.devices import Cell
from cellctl.errors import CellError
from cellctl.errors.link import LinkError


def device_links(cell: Cell, faults: Iterable[CellError]) -> dict[str, str]:
    """State of each link by kind and name; ``faults`` are those that the unit has latched."""
    links = {name: _problem(check) for name, check in cell.health_checks().items()}
    return links | _answers(cell, _latched(faults))


def _answers(cell: Cell, latched: Mapping[str, str]) -> dict[str, str]:
    """By device that reports nothing by itself: why it did not answer when it was asked last.

    A fault of its link that is latched counts as well: in a run nobody else asks it. Nothing before
    all devices are connected: none of them was asked then.
    """
    kinds: dict[str, Iterable[str]] = {
        "stereo_cameras": cell.stereo_cameras,
        "cameras": cell.cameras,
        "trackers": cell.trackers,
        "grippers": cell.grippers,
        "digital_ios": cell.digital_ios,
    }
    asked = [(kind, name) for kind, names in kinds.items() for name in names if cell.connected]
    return {
        f"{kind}.{name}": str(cell.unanswered.get(name, latched.get(name, "")))
        for kind, name in asked
    }


def _latched(faults: Iterable[CellError]) -> Mapping[str, str]:
    """Faults of links by the name with which their facts begin, that of their device."""
    return {
        fault.detail.partition(":")[0].partition(",")[0]: str(fault)
        for fault in faults
        if isinstance(fault, LinkError)
    }


def _problem(check: Callable[[], object]) -> str:
    try:
        check()
    except CellError as error:
        return str(error)
    return ""
