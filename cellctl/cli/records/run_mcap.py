"""`cellctl runs export --mcap`: a run as one file for Foxglove, with a layout beside it."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from cellctl.records.store import RunStore

LAYOUT = ".foxglove.json"
"""Ends the name of the layout, in place of ``.mcap``."""


class Images(StrEnum):
    """What becomes of the raw images; the values are those of ``ImageForm``."""

    LOSSLESS = "lossless"
    JPEG = "jpeg"
    NONE = "none"


def write_mcap(store: "RunStore", run: int, out: Path | None, images: Images) -> None:
    """Write both files; what the run lacks is told on standard error."""
    # Loaded here: other commands do without the message formats of viewers.
    from cellctl.errors.records.store import RecordNotWritten
    from cellctl.files.atomic_files import write_durably
    from cellctl.records.run_mcap.export import export_mcap
    from cellctl.records.run_mcap.images import ImageForm
    from cellctl.records.run_mcap.layout import layout_for

    path = out or Path(f"run-{run}.mcap")
    exported = export_mcap(store, run, path, ImageForm(images.value))
    layout = path.with_suffix(LAYOUT)
    try:
        write_durably(layout, layout_for(exported.messages, exported.frames).encode())
    except OSError as error:
        raise RecordNotWritten(f"{layout}: {error.strerror}") from error
    for text in exported.missing:
        typer.echo(f"missing: {text}", err=True)
    messages = sum(exported.messages.values())
    size_mb = path.stat().st_size / 1e6
    typer.echo(f"{path}: {messages} messages on {len(exported.messages)} topics, {size_mb:.1f} MB")
    typer.echo(f"{layout}: layout for Foxglove")
