"""The user who types at this PC, as the system knows them."""

import os
import pwd


def terminal_user() -> str:
    """``terminal:NAME``, as the daemon names users of its socket; the number where it has none."""
    uid = os.getuid()
    try:
        return f"terminal:{pwd.getpwuid(uid).pw_name}"
    except KeyError:
        return f"terminal:{uid}"
