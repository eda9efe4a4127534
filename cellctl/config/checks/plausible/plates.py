"""Type plates that two devices cannot share."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue, WrittenValue


def plate_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Serial numbers of two devices of one kind: a section was copied, and its plate with it.

    The record of a run would trace both to the papers of one. Makers number each kind for itself,
    so that a robot may have the number of a camera.
    """
    first: dict[tuple[str, str], str] = {}
    for path, (_, device) in cell.devices().items():
        number = device.serial_number.strip()
        kind = f"{path.split('.')[0]} {device.driver}"
        if not number:
            continue
        other = first.setdefault((kind, number), path)
        # A stop channel is a second link to a robot that has its plate.
        if other != path and path.count(".") == 1:
            key = f"{path}.serial_number"
            allowed = f"another one than {other} has: two devices, two plates"
            against = (WrittenValue(f"{other}.serial_number", repr(number)),)
            yield ConfigIssue(key, repr(device.serial_number), allowed, against=against)
