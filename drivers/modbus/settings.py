"""What every driver behind a Modbus TCP coupler has in its section of the cell file. Seconds."""

from collections.abc import Iterable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Seconds = Annotated[float, Field(gt=0.0, le=60.0)]
Address = Annotated[int, Field(ge=0, le=65535)]
"""0-based, as on the wire."""
MAX_SPAN = 2000
"""Bits that one Modbus request can read."""


class CouplerSettings(BaseModel):
    """Where the coupler listens, how long it may take, and where its watchdog is."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    host: str
    port: Annotated[int, Field(ge=1, le=65535)] = 502
    unit: Annotated[int, Field(ge=0, le=255)] = 1
    connect_timeout_s: Seconds = 5.0
    reply_timeout_s: Seconds = 0.5
    watchdog_register: Address = 0x1120
    """Holding register with the time after which a coupler without requests drops its outputs."""
    watchdog_unit_ms: Annotated[int, Field(ge=1, le=1000)] = 1
    """What one count of that register stands for."""
    max_watchdog_s: Seconds = 1.0
    """A coupler that would keep its outputs longer than this without a request is refused."""


def check_addresses(what: str, addresses: Iterable[int]) -> None:
    """``ValueError`` when two signals share an address or one request cannot span them all."""
    used = list(addresses)
    if len(set(used)) != len(used):
        raise ValueError(f"{what} must have different addresses")
    if used and max(used) - min(used) >= MAX_SPAN:
        raise ValueError(f"{what} must lie within {MAX_SPAN} addresses")
