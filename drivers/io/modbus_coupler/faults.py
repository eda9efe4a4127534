"""Translates a signal that the cell file does not name to a numbered fault of the cell.

What the coupler and its connection may do wrong is translated in ``drivers.modbus.faults``.
"""

from collections.abc import Iterable, Sequence

from cellctl.errors.digital_io import SignalUnknown


def unknown(device: str, names: Iterable[str], known: Sequence[str]) -> SignalUnknown:
    """Fault of outputs that this device does not have."""
    return SignalUnknown(f"{device}: {', '.join(names)}; outputs are {', '.join(known) or 'none'}")
