"""Time limits so short that every answer is late, exposures so long that nothing stands still."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.document.leaves import leaves
from cellctl.config.issue import ConfigIssue

_LEAST_S = 0.02
"""Twice the pause that an ordinary Linux PC under load takes now and then."""
_LONGEST_EXPOSURE_S = 1.0
_NAMES = ("silence_s", "stale_s", "max_deadman_s")


def wait_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Limits of silence, dead men and timeouts below what network and PC need; 0 has a meaning of
    its own where a driver allows it."""
    for key, value in leaves(cell.model_dump()):
        name = key.rsplit(".", 1)[-1]
        if not isinstance(value, int | float) or isinstance(value, bool):
            continue
        if (name in _NAMES or name.endswith("timeout_s")) and 0.0 < value < _LEAST_S:
            allowed = f"at least {_LEAST_S:g} seconds: a PC that pauses for less is in order"
            yield ConfigIssue(key, f"{value:g}", allowed)
        if name == "exposure_s" and value > _LONGEST_EXPOSURE_S:
            allowed = f"at most {_LONGEST_EXPOSURE_S:g} second; this looks like milliseconds"
            yield ConfigIssue(key, f"{value:g}", allowed)
