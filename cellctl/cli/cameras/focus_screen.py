"""The table of `cellctl focus`."""

from collections.abc import Mapping

from rich.table import Table

from cellctl.cli.cameras.focus_view import FocusView, SideView

_NOTHING = "–"


def screen(name: str, seen: FocusView, sharpest_px: Mapping[str, float] | None = None) -> Table:
    """One column for each image; ``sharpest_px`` is the least blur so far by side."""
    title = f"{name}: frame {seen.frame_id}, {seen.took_s * 1e3:.0f} ms"
    table = Table("", *(one.side for one in seen.sides), title=title)
    table.add_row(
        "blur of the sharpest edges, px", *(_px(one.figures.blur_px) for one in seen.sides)
    )
    if sharpest_px is not None:
        best = [_px(sharpest_px.get(one.side)) for one in seen.sides]
        table.add_row("  least so far, px", *best, style="dim")
    table.add_row("median grey", *(f"{one.figures.median_grey:.0f}" for one in seen.sides))
    table.add_row("bright grey (99.8 %)", *(f"{one.figures.bright_grey:.0f}" for one in seen.sides))
    table.add_row("saturated", *(_share(one.figures.saturated_share) for one in seen.sides))
    table.add_row("black", *(_share(one.figures.black_share) for one in seen.sides))
    table.add_row("exposure, gain", *map(_exposure, seen.sides))
    if any(one.board_corners is not None for one in seen.sides):
        table.add_row("corners of the board", *(_found(one.board_corners) for one in seen.sides))
    if any(one.holes is not None for one in seen.sides):
        table.add_row("holes", *(_found(one.holes) for one in seen.sides))
    if len(seen.sides) > 1:
        overlap = _NOTHING if seen.overlap_share is None else f"{seen.overlap_share:.0%}"
        table.add_row("left view seen by right", overlap, *[""] * (len(seen.sides) - 1))
    return table


def _px(value: float | None) -> str:
    return _NOTHING if value is None else f"{value:.2f}"


def _share(value: float) -> str:
    return f"{value:.2%}"


def _exposure(one: SideView) -> str:
    exposure = _NOTHING if one.exposure_s is None else f"{one.exposure_s * 1e3:g} ms"
    gain = _NOTHING if one.gain_db is None else f"{one.gain_db:g} dB"
    return f"{exposure}, {gain}"


def _found(count: int | None) -> str:
    return str(count) if count else "not found"
