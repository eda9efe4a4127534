"""8xx: run store and artefacts."""

from cellctl.errors.base import CellError


class RecordsError(CellError):
    """The record could not be kept."""
