"""What goes over a connection to the service, whoever packs and reads it."""

from dataclasses import dataclass

from cellctl.errors.link import VersionMismatch

Value = bool | int | str | list[float] | list[int] | list[str] | None
"""What a reply carries; None for a call without a result."""
Argument = bool | int | float | str | list[float]
SEQUENCE_NUMBER = 0
"""The service does not count calls: replies come in the order of the calls of their connection."""


class MethodUnknown(VersionMismatch):
    """The controller's software does not have a call. Raised for the one that asked."""


@dataclass(frozen=True, slots=True)
class Request:
    """A call that is packed and can be sent at any time."""

    method: str
    data: bytes
