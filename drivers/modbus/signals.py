"""Names of digital signals and the bits that stand for them, without I/O."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SignalMap:
    """Signals of one direction: the names of the cell file and their addresses."""

    addresses: Mapping[str, int]

    @property
    def start(self) -> int:
        """Lowest address; 0 without signals."""
        return min(self.addresses.values(), default=0)

    @property
    def count(self) -> int:
        """Bits from the lowest to the highest address; 0 without signals."""
        # One request for the whole span, with what lies between: all values are then of one moment.
        return max(self.addresses.values(), default=-1) - self.start + 1

    def values(self, bits: Sequence[bool]) -> dict[str, bool]:
        """The named values among ``count`` bits that begin at ``start``."""
        return {name: bits[address - self.start] for name, address in self.addresses.items()}
