"""Where the sockets' errors become numbered faults of the cell."""

from cellctl.errors.link import ConnectTimeout, LinkError, LinkLost, ReplyTimeout


def cannot_connect(peer: str, error: OSError) -> LinkError:
    """Fault of a connection that could not be made. ``TimeoutError`` is an ``OSError`` too."""
    return ConnectTimeout(f"{peer}: {error.strerror or 'no answer'}")


def broken(peer: str, error: Exception) -> LinkError:
    """Fault of a connection that ended in the middle of an exchange."""
    return LinkLost(f"{peer}: {error or 'closed'}")


def silent(peer: str, timeout_s: float) -> LinkError:
    """Fault of a reply that did not come."""
    return ReplyTimeout(f"{peer}: no reply within {timeout_s:g} s")
