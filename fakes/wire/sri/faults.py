"""Faults that the fake box can be told to have, by name."""

from dataclasses import dataclass, fields


@dataclass(slots=True)
class SriFaults:
    """All off by default. ``every`` fields: 0 is never, n is each n-th frame
    (of ``jump_every``: point)."""

    split: bool = False
    """Cut the byte stream anywhere but between frames."""
    coalesce: int = 1
    """Gather this many frames into one write."""
    ack_in_stream_every: int = 0
    """Put an ACK line between two frames."""
    corrupt_every: int = 0
    """Flip a bit in the data, so that the check no longer fits."""
    skip_every: int = 0
    """Count a frame but do not send it; on CAN one of the three messages is lost."""
    header_in_data: bool = False
    """AA 55 in every channel (float32 low bytes; less than 1 % of the value) and a complete false
    header, length included, in place of Mx (which then reads as 1e-22)."""
    stale_stream: bool = False
    """Stream to a client at once, as after a session that was never stopped."""
    no_smpf: bool = False
    """Older firmware: SMPF is an error, SMPR works."""
    silent: bool = False
    """No frames, although commands are answered."""
    frozen: bool = False
    """The values stop changing; numbers go on."""
    uncounted: bool = False
    """Every frame has the package number of the last one before; the values go on."""
    jump_every: int = 0
    """Half the scale is added to all channels of that point, as a loose contact does."""
    saturated: bool = False
    """Every channel at its end of scale."""
    nan: bool = False
    """Bytes FF FF FF FF in each float, counts 65535."""
    half_open: bool = False
    """The link stands but nothing is read or written."""
    late_s: float = 0.0
    """Send every frame that much after its sample."""

    def inject(self, name: str, value: float = 1) -> None:
        """Set one fault by name; ``ValueError`` for a name that does not exist."""
        kinds = {field.name: type(getattr(self, field.name)) for field in fields(self)}
        if name not in kinds:
            raise ValueError(f"no such fault: {name}; there are {', '.join(kinds)}")
        setattr(self, name, kinds[name](value))

    def clear(self) -> None:
        """Back to a healthy box."""
        healthy = SriFaults()
        for field in fields(self):
            setattr(self, field.name, getattr(healthy, field.name))
