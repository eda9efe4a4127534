"""The operator of the fake cell: what the control port can ask for."""

from typing import TYPE_CHECKING, Any, cast, get_args

from fakes.control import Handler
from fakes.faults import CATALOGUE, FaultBoard
from fakes.scenario import HeadName, RobotName

if TYPE_CHECKING:
    from fakes.cell import Cell

_SELF_MANAGED = ("sensor", "head_1", "head_2")
"""Devices that keep their faults themselves."""


class Operator:
    """Handlers of the control port, one method a command."""

    def __init__(self, cell: "Cell") -> None:
        self._cell = cell

    def handlers(self) -> dict[str, Handler]:
        """Commands by name."""
        return {
            "status": self.status,
            "truth": self.truth,
            "load": self.load,
            "present": self.present,
            "reset_peak": self.reset_peak,
            "place_target_board": self.place_target_board,
            "place_chessboard": self.place_chessboard,
            "remove_boards": self.remove_boards,
            "inject": self.inject,
            "clear": self.clear,
            "faults": self.faults,
            "shutdown": self.shutdown,
        }

    async def status(self) -> dict[str, Any]:
        """Time of the world and the channels that the PC has accepted."""
        channels = {name: robot.open_channels for name, robot in self._cell.robots.items()}
        return {"time_s": self._cell.now_s(), "channels": channels}

    async def truth(self) -> dict[str, Any]:
        """Everything that nobody in the cell knows exactly."""
        return {"truth": self._cell.world.report()}

    async def load(self) -> dict[str, Any]:
        """The next frame and the next deck; forgets the peak of the contact force."""
        self._cell.world.load_parts()
        return {"load": self._cell.world.loads}

    async def present(self, frame: bool | None = None, deck: bool | None = None) -> dict[str, Any]:  # noqa: FBT001
        """Take frame or deck away, or bring them back."""
        self._cell.world.set_present(frame=frame, deck=deck)
        return {}

    async def reset_peak(self) -> dict[str, Any]:
        """Forget the peak of the contact force."""
        self._cell.world.payload.peak_contact_force_n = 0.0
        return {}

    async def place_target_board(self, head: str, number: int = 0) -> dict[str, Any]:
        """Lay board P under a head."""
        self._cell.world.place_target_board(_head(head), int(number))
        return {}

    async def place_chessboard(self, head: str, number: int = 0) -> dict[str, Any]:
        """Hold the chessboard under a head; another number is another view."""
        self._cell.world.place_chessboard(_head(head), int(number))
        return {}

    async def remove_boards(self) -> dict[str, Any]:
        """Take both boards away."""
        self._cell.world.remove_boards()
        return {}

    async def inject(self, device: str, name: str, **parameters: Any) -> dict[str, Any]:
        """Inject a fault; ``count`` limits how often it acts."""
        if name == "reboot" and device in get_args(RobotName):
            await self._cell.robots[cast(RobotName, device)].reboot()
            return {}
        self._board(device).inject(name, **parameters)
        if device == "world":
            self._cell.world.rebuild()
        return {}

    async def clear(self, device: str, name: str | None = None) -> dict[str, Any]:
        """End one fault of a device, or all of them."""
        if device in _SELF_MANAGED:
            self._board(device).clear()
        else:
            self._board(device).clear(name)
        if device == "world":
            self._cell.world.rebuild()
        return {}

    async def faults(self) -> dict[str, Any]:
        """Faults that can be injected, with their meaning, and those that are."""
        active = {device: self._board(device).names() for device in CATALOGUE}
        return {"known": CATALOGUE, "active": active}

    async def shutdown(self) -> dict[str, Any]:
        """End the process."""
        self._cell.stopping.set()
        return {}

    def _board(self, device: str) -> Any:
        cell = self._cell
        boards: dict[str, FaultBoard | Any] = {
            "world": cell.world.faults,
            "large_field": cell.targets.faults,
            "sensor": cell.sensor.faults,
            **{name: robot.faults for name, robot in cell.robots.items()},
            **{name: head.faults for name, head in cell.heads.items()},
        }
        if device not in boards:
            raise ValueError(f"unknown device {device!r}; known: {sorted(boards)}")
        return boards[device]


def _head(name: str) -> HeadName:
    if name not in get_args(HeadName):
        raise ValueError(f"unknown head {name!r}")
    return cast(HeadName, name)
