"""`cellctl runs report`: the report of a run as one file, to be sent or printed."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.terminal.consoles import console_of_lines


def report(
    run: Annotated[int, typer.Argument(help="Number of the run.", min=1)],
    *,
    pdf: Annotated[bool, typer.Option("--pdf", help="As PDF on A4 in place of HTML.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="File; default: run-NUMBER.html or .pdf.")
    ] = None,
    data_dir: DataDir = None,
) -> None:
    """Write the report of a run as one file with its pictures, HTML or PDF."""
    # Only a report is drawn; the list of runs does not wait for what draws.
    from cellctl.cli.records.process_pages import pages_of
    from cellctl.records.report.export import write_report

    path = out or Path(f"run-{run}.{'pdf' if pdf else 'html'}")
    with opened_store(data_dir) as store:
        pages = pages_of(store.run(run).head.process)
        with console_of_lines(stderr=True).status("drawing the report") as status:

            def tell(step: str) -> None:
                status.update(f"PDF: {step}")

            write_report(store, run, path, pages=pages, pdf=pdf, tell=tell)
    typer.echo(path)
