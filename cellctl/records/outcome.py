"""How a run ended, in the words of lists and screens."""

from cellctl.records.entries import DRY_RUN, RunResult

GOOD_ENDS = frozenset({"good", "done, no part"})
"""Words of the ends at which there is nothing to look into."""


def result_at_end(mode: str) -> RunResult:
    """The result of a run of this mode that came to its end: a dry run makes no good part."""
    return RunResult.BAD if mode == DRY_RUN else RunResult.GOOD


def outcome(mode: str, result: str | None, *, spoilt: bool = False) -> str:
    """``mode`` and ``result`` as recorded; ``spoilt``: a plug gauge is beyond its limit.

    A dry run that came to its end is recorded as bad, because it has made no good part. Nothing is
    bad about it.
    """
    if result is None:
        return "open"
    if mode == DRY_RUN and result == result_at_end(mode):
        return "done, no part"
    return "good, bad by gauge" if spoilt else str(result)
