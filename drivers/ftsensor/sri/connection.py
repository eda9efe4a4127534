"""The interface of a transport: bytes and a descriptor, without waiting."""

from abc import ABC, abstractmethod


class Connection(ABC):
    """One link to the box. Only ``wait`` blocks, and a ``connect`` that has to look up a name.

    All methods but ``close`` and ``fileno`` raise ``LinkLost`` or ``ConnectTimeout`` and leave the
    link closed then.
    """

    peer: str
    """The other end, for messages."""

    @abstractmethod
    def connect(self) -> None:
        """Begin to connect."""

    @abstractmethod
    def established(self) -> bool:
        """True once bytes can flow."""

    @abstractmethod
    def close(self) -> None:
        """Drop the link. Idempotent."""

    @abstractmethod
    def fileno(self) -> int:
        """Descriptor that becomes readable when bytes wait; -1 while closed."""

    @abstractmethod
    def wait(self, timeout_s: float) -> None:
        """Wait until there is something to do, or until the time is over."""

    @abstractmethod
    def send(self, data: bytes) -> None:
        """Hand over one command."""

    @abstractmethod
    def receive(self) -> bytes:
        """What has arrived; empty when nothing has."""
