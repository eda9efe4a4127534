"""What the devices that measure have said of themselves, for the record of a run."""

from cellctl.cell.devices import Cell
from cellctl.records.entries import Document
from cellctl.records.parts import TOLD


def told_devices(cell: Cell) -> Document:
    """Robots and force sensors, by their names; of one that says nothing there is no entry.

    Only what is known already is taken: no device is asked while a part waits. Serial numbers of
    cameras stand at their calibrations and images.
    """
    robots = {
        name: ", ".join(f"{what} {said}" for what, said in robot.link_facts().items())
        for name, robot in cell.robots.items()
    }
    sensors = {name: guard.health().sensor_serial for name, guard in cell.guards.items()}
    return Document(TOLD, {name: said for name, said in (robots | sensors).items() if said})
