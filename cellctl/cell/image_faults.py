"""Says of which camera or head an image is that cannot be measured: an operator has to go there."""

from collections.abc import Iterator
from contextlib import contextmanager

from cellctl.errors.vision import OF_AN_IMAGE


@contextmanager
def naming(device: str) -> Iterator[None]:
    """Faults of an image begin with ``device``, its camera or head in the cell file.

    What looks into an image knows its side alone.
    """
    try:
        yield
    except OF_AN_IMAGE as fault:
        raise type(fault)(f"{device}, {fault.detail}") from fault
