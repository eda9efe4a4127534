"""The two register blocks, and what a Modbus client may do to them on any transport."""

from collections.abc import Callable, Sequence

from cellctl.api.modbus.register_map import HOLDING, HOLDING_SIZE, INPUT_SIZE, item

_OWNER = {address: item.addresses for item in HOLDING for address in item.addresses}
_COMMIT = item("cmd_seq").address
_HEARTBEAT = item("plc_heartbeat").address


class AddressRefused(Exception):  # an answer to the client, not a fault of the cell
    """Outside the map, or part of an item only: Modbus exception 02."""


class RegisterFile:
    """The holding registers, which the line writes, and the input registers, which the cell writes.

    Reads and writes do not await, so no request sees another one half done.
    """

    def __init__(
        self, *, on_commit: Callable[[str], None], on_heartbeat: Callable[[str, int], None]
    ) -> None:
        """Both are called with the address of the client that has written."""
        self._holding = [0] * HOLDING_SIZE
        self._written: dict[str, list[int]] = {}
        """What each client has written last into each holding register, by its address."""
        self._input: tuple[int, ...] = (0,) * INPUT_SIZE
        self._on_commit = on_commit
        self._on_heartbeat = on_heartbeat

    @property
    def holding(self) -> tuple[int, ...]:
        """A copy of the holding block."""
        return tuple(self._holding)

    def written_by(self, client: str) -> tuple[int, ...]:
        """What this client has written last into each holding register; 0 where it never has.

        A command is not put together from words of two clients: one that writes its whole image
        again and again would turn the Stop of another, whose number follows in a request of its
        own, into its own last command.
        """
        return tuple(self._written.get(client, [0] * HOLDING_SIZE))

    def publish(self, block: tuple[int, ...]) -> None:
        """Replace all input registers at once."""
        if len(block) != INPUT_SIZE:
            raise ValueError(f"the input block has {INPUT_SIZE} registers, got {len(block)}")
        self._input = block

    def read_input(self, address: int, count: int) -> tuple[int, ...]:
        """FC4; spare registers read 0. Raises ``AddressRefused``."""
        if address + count > INPUT_SIZE:
            raise AddressRefused
        return self._input[address : address + count]

    def read_holding(self, address: int, count: int) -> tuple[int, ...]:
        """FC3. Raises ``AddressRefused``."""
        if any(register not in _OWNER for register in range(address, address + count)):
            raise AddressRefused
        return tuple(self._holding[address : address + count])

    def write_holding(self, address: int, values: Sequence[int], client: str) -> None:
        """FC6, 16, 22, 23: all or nothing; an item is written whole or not at all.

        ``client`` is the address that the request came from.

        Raises ``AddressRefused``.
        """
        written = range(address, address + len(values))
        for register in written:
            owner = _OWNER.get(register)
            if owner is None or owner[0] not in written or owner[-1] not in written:
                raise AddressRefused
        self._holding[address : address + len(values)] = values
        own = self._written.setdefault(client, [0] * HOLDING_SIZE)
        own[address : address + len(values)] = values
        # The heartbeat first: a command in the same request must not be refused for its absence.
        if _HEARTBEAT in written:
            self._on_heartbeat(client, self._holding[_HEARTBEAT])
        if _COMMIT in written:
            self._on_commit(client)
