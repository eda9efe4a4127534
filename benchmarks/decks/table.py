"""The campaign as Markdown: what became of each deck, and what `cellctl check` says of it."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from benchmarks.decks.chain import Figures, Outcome
from benchmarks.decks.deck_range import Deck

_COLUMNS: tuple[tuple[str, str, Callable[[Figures], float | None]], ...] = (
    ("looks", "{:.0f}", lambda one: one.looks),
    ("tilt off the truth °", "{:.4f}", lambda one: one.off_tilt_deg),
    ("approach mm/s", "{:.3f}", lambda one: one.speed_mm_s),
    ("pins mm", "{:.3f}", lambda one: one.lateral_mm),
    ("gap mm", "{:.3f}", lambda one: None if one.gap_mm is None else abs(one.gap_mm)),
    ("peak N", "{:.1f}", lambda one: one.peak_n),
)


def markdown(
    decks: Sequence[Deck], results: Sequence[Figures], refusals: Mapping[str, Sequence[str]]
) -> str:
    """One row a deck, the worst figure of its seeds; then the reasons."""
    head = ["deck", "face m", "triangles mm", "good", *(title for title, _, _ in _COLUMNS), "check"]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    notes: list[str] = []
    for deck in decks:
        tried = [one for one in results if one.deck == deck.key]
        if not tried:
            continue
        good = sum(one.outcome is Outcome.GOOD for one in tried)
        refused = refusals[deck.key]
        name = f"{deck.mass_kg:g} kg"
        cells = [
            name,
            f"{deck.length_m:g} × {deck.width_m:g}",
            f"{deck.legs_mm:g}",
            f"{good} of {len(tried)}",
            *(_worst(form, [value(one) for one in tried]) for _, form, value in _COLUMNS),
            "refuses" if refused else "good",
        ]
        lines.append("| " + " | ".join(cells) + " |")
        title = f"{name}, {cells[1]} m, {cells[2]} mm"
        notes += [f"- {title}: check: {text}" for text in refused]
        reasons = sorted({one.text for one in tried if one.text})
        notes += [f"- {title}: {text}" for text in reasons]
    false = [one for one in results if one.outcome is Outcome.FALSE]
    notes += [f"- **{one.deck}, seed {one.seed}: called good, is not**" for one in false]
    return "\n".join([*lines, "", *notes, ""])


def _worst(form: str, values: Sequence[float | None]) -> str:
    known = [value for value in values if value is not None]
    return form.format(np.max(known)) if known else "–"
