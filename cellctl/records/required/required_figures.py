"""Figures without which no part is good, and those that a run has ended without."""

from collections.abc import Iterable
from dataclasses import dataclass

from cellctl.records.entries import Document, Figure, RunRecord
from cellctl.records.figures import Limit, figure

REQUIRED = "required_figures"
"""Key of the document that a run of Production begins with."""
_INSTEAD = "instead"


@dataclass(frozen=True, slots=True)
class RequiredFigure:
    """A figure that every good part of a recipe has."""

    figure: Figure
    """Its value is not known yet. Its limit is that of the recipe: what was measured may be judged
    by a narrower one, less its uncertainty."""
    instead: str = ""
    """Key of the figure that counts in its place, in the runs that have that one."""


def required(key: str, unit: str, limit: Limit, *, instead: str = "") -> RequiredFigure:
    """A figure that is not measured yet; its label is that of its key."""
    return RequiredFigure(figure(key, None, unit, limit=limit), instead)


def required_document(required_figures: Iterable[RequiredFigure]) -> Document:
    """The required figures in the form that the record of a run keeps."""
    content = {
        one.figure.key: {
            "label": one.figure.label,
            "unit": one.figure.unit,
            "lower": one.figure.lower,
            "upper": one.figure.upper,
            _INSTEAD: one.instead,
        }
        for one in required_figures
    }
    return Document(REQUIRED, content)


def states_required(record: RunRecord) -> bool:
    """Whether a run says what it requires; those of earlier versions and dry runs do not."""
    return bool(record.document(REQUIRED))


def missing_figures(record: RunRecord) -> tuple[Figure, ...]:
    """The figures that a run requires and has not measured, without a value.

    A run that is still open has them as well: it may still measure them.
    """
    found = record.newest_figures
    return tuple(
        Figure(key, one["label"], None, one["unit"], one["lower"], one["upper"])
        for key, one in record.document(REQUIRED).items()
        if key not in found and one[_INSTEAD] not in found
    )


def not_measured(record: RunRecord) -> tuple[Figure, ...]:
    """The required figures that a run has ended without; none while the run is open."""
    return () if record.head.result is None else missing_figures(record)
