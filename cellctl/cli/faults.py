"""`cellctl faults`: the fault catalogue, from the code, or one fault of it."""

import json
from collections.abc import Iterable
from typing import Annotated

import typer

from cellctl.errors import CellError
from cellctl.fault_catalogue import known_faults

Number = Annotated[int | None, typer.Argument(help="Number of a fault, without the F.")]
AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]


def faults(number: Number = None, *, as_json: AsJson = False) -> None:
    """All faults, installed packages' included, as Markdown; or one with cause and remedy."""
    found = known_faults()
    if number is not None:
        found = [fault for fault in found if fault.number == number]
        if not found:
            raise typer.BadParameter(_neighbours(number), param_hint="NUMBER")
    if as_json:
        typer.echo(json.dumps([_plain(fault) for fault in found], indent=2, ensure_ascii=False))
    elif number is not None:
        typer.echo(_one(found[0]))
    else:
        typer.echo(catalogue_page(found), nl=False)


def _plain(fault: type[CellError]) -> dict[str, str | int]:
    return {
        "number": fault.number,
        "text": fault.text,
        "cause": fault.cause,
        "remedy": fault.remedy,
        "reaction": fault.reaction.value,
    }


def _one(fault: type[CellError]) -> str:
    return (
        f"F{fault.number:03d} {fault.text}\n"
        f"  cause:    {fault.cause}\n"
        f"  remedy:   {fault.remedy}\n"
        f"  reaction: {fault.reaction.value}"
    )


def _neighbours(number: int) -> str:
    """The numbers of the same hundred, among which the one that is meant may be."""
    near = [f"{one.number}" for one in known_faults() if one.number // 100 == number // 100]
    return f"there is no F{number:03d}; of its hundred: {', '.join(near) or 'none'}"


def catalogue_page(faults: Iterable[type[CellError]]) -> str:
    """A catalogue of these faults as Markdown."""
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
        for fault in faults
    ]
    return "\n".join(lines) + "\n"
