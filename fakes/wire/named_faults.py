"""Faults of one fake device, switched on by name, for good or for its next replies."""

from collections.abc import Iterable


class NamedFaults:
    """A name that does not exist is a ``ValueError``."""

    def __init__(self, names: Iterable[str]) -> None:
        self._names = tuple(names)
        self._values: dict[str, float] = {}
        self._replies_left: dict[str, int] = {}

    def inject(self, name: str, value: float = 1.0, *, replies: int | None = None) -> None:
        """Switch a fault on, until ``clear`` or for the next ``replies``."""
        if name not in self._names:
            raise ValueError(f"no such fault: {name}; there are {', '.join(self._names)}")
        self._values[name] = value
        self._replies_left.pop(name, None)
        if replies is not None:
            self._replies_left[name] = replies

    def clear(self, name: str | None = None) -> None:
        """Switch one fault, or all of them, off."""
        for key in [name] if name is not None else list(self._values):
            self._values.pop(key, None)
            self._replies_left.pop(key, None)

    def take(self) -> dict[str, float]:
        """Faults of the reply that is due now, with their values."""
        active = dict(self._values)
        for name in active:
            if name in self._replies_left:
                self._replies_left[name] -= 1
                if self._replies_left[name] <= 0:
                    self.clear(name)
        return active
