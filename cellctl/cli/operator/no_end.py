"""Validity that somebody has meant to last for ever."""

from datetime import datetime, timedelta

_NO_END = timedelta(days=36_500)
"""A century: what is valid for longer was stored as valid for ever."""


def without_end(valid_until: datetime, now: datetime) -> bool:
    """Whether nobody needs to be told a date; both moments with their time zone."""
    return valid_until - now > _NO_END
