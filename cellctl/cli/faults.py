"""`cellctl faults`: the fault catalogue, from the code."""

import typer

from cellctl.errors import catalogue


def faults() -> None:
    """Print the fault catalogue as Markdown (docs/faults.md)."""
    typer.echo(fault_catalogue(), nl=False)


def fault_catalogue() -> str:
    """The catalogue as Markdown."""
    lines = [
        "# Fault catalogue",
        "",
        "Made by `cellctl faults`. The number goes to the PLC, the text to the operator.",
        "",
        "| number | what happened | likely cause | what to do | reaction |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| F{fault.number:03d} | {fault.text} | {fault.cause} | {fault.remedy} "
        f"| {fault.reaction.value} |"
        for fault in catalogue()
    ]
    return "\n".join(lines) + "\n"
