"""The known word that a misspelt one resembles."""

import difflib
from collections.abc import Iterable


def nearest(word: str, known: Iterable[str], *, least_ratio: float = 0.6) -> str:
    """``did you mean 'x'? `` for a word that resembles a known one, else nothing.

    ``least_ratio`` is the least share of common letters, as ``difflib`` counts it.
    """
    close = difflib.get_close_matches(word, list(known), n=1, cutoff=least_ratio)
    return f"did you mean '{close[0]}'? " if close else ""
