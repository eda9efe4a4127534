"""`cellctl keys`: every key that a cell file may have, from the code, or some of them."""

from collections.abc import Iterable, Iterator
from typing import Annotated

import typer

from cellctl.config.document.key_reference import (
    NEEDED,
    NONE,
    Key,
    KeyTable,
    cell_file_tables,
    driver_tables,
    process_tables,
)
from cellctl.spelling import nearest

_INTRODUCTION = """\
# Keys of the cell file

Made by `cellctl keys`, from the models that read the file; `cellctl keys WORD` shows the keys with
that word in their name. `NAME` stands for a name that you choose. A key that is not listed is
refused, and so is a value beyond what is allowed here. What the values have to be together is said
by `cellctl check`; how to find them, by [commissioning.md](commissioning.md).
"""
_HEADS = ("key", "what is written", "default", "meaning")

Word = Annotated[str, typer.Argument(help="Part of the name of a key, such as stand_off.")]


def keys(word: Word = "") -> None:
    """All keys of a cell file, with those of drivers and processes; or some in few words."""
    if not word:
        typer.echo(key_page(), nl=False)
        return
    found = [
        (whose, table, key) for whose, table in _all() for key in table.keys if word in key.name
    ]
    if not found:
        known = {key.name for _, table in _all() for key in table.keys}
        raise typer.BadParameter(f"{nearest(word, known)}no key has it", param_hint="WORD")
    typer.echo("\n".join(line for entry in found for line in _told(*entry)))


def key_page() -> str:
    """Everything as Markdown."""
    lines = [
        _INTRODUCTION,
        "## Every cell",
        *_sections(("", table) for table in cell_file_tables()),
    ]
    lines += ["## Settings of drivers", *_sections(driver_tables())]
    lines += ["## Processes", *_sections(process_tables())]
    return "\n".join(lines)


def _all() -> Iterator[tuple[str, KeyTable]]:
    yield from (("", table) for table in cell_file_tables())
    yield from driver_tables()
    yield from process_tables()


def _told(whose: str, table: KeyTable, key: Key) -> Iterator[str]:
    place = table.header or "before the first table"
    yield f"{key.name}  {place}" + (f", {whose.replace('`', '')}" if whose else "")
    yield f"  {key.what}; " + (key.default if key.default == NEEDED else f"default: {key.default}")
    if key.meaning:
        yield f"  {key.meaning.replace('``', '')}"


def _sections(tables: Iterable[tuple[str, KeyTable]]) -> Iterator[str]:
    shown = ""
    for whose, table in tables:
        if whose != shown:
            shown = whose
            yield from ("", f"### {whose}")
        yield ""
        header = f"`{table.header}`" if table.header else "Before the first table"
        yield f"{header}: {_marked(table.about)}"
        yield ""
        yield _row(*_HEADS)
        yield "|---|---|---|---|"
        for key in table.keys:
            default = key.default if key.default in (NEEDED, NONE) else f"`{key.default}`"
            yield _row(f"`{key.name}`", _marked(key.what), default, _marked(key.meaning))
    yield ""


def _marked(text: str) -> str:
    return text.replace("``", "`").replace("|", "\\|")


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
