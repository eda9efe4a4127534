"""`cellctl faults`: the fault catalogue, from the code, or one fault of it."""

import json
from collections.abc import Iterable
from enum import StrEnum
from typing import Annotated

import typer
from rich.cells import cell_len
from rich.console import Console

from cellctl.errors import CellError
from cellctl.errors.base import Reaction, fault_number
from cellctl.fault_catalogue import known_faults
from cellctl.terminal.consoles import console_of_lines, print_hanging
from cellctl.translations import fault_words


class Language(StrEnum):
    """Languages of the catalogue."""

    ENGLISH = "en"
    CHINESE = "zh"


_HEADS = {
    Language.ENGLISH: ("number", "what happened", "likely cause", "what to do", "reaction"),
    Language.CHINESE: ("编号", "故障", "可能原因", "处理方法", "反应"),
}
_INTRODUCTIONS = {
    Language.ENGLISH: (
        "# Fault catalogue",
        "Made by `cellctl faults`. The number goes to the PLC, the text to the operator.",
    ),
    Language.CHINESE: (
        "# 故障目录",
        "由 `cellctl faults --lang zh` 生成。编号发给 PLC，文字显示给操作员。[English](faults.md)",
    ),
}
_REACTIONS = {
    Reaction.WARN: "警告",
    Reaction.HOLD: "保持",
    Reaction.STOP: "停止",
    Reaction.ABORT: "中止",
}
_PARTS = {
    Language.ENGLISH: ("cause:    ", "remedy:   ", "reaction: "),
    Language.CHINESE: ("原因：", "处理：", "反应："),
}

Number = Annotated[
    int | None,
    typer.Argument(
        parser=fault_number, help="Number of a fault, such as F529 or 529.", metavar="NUMBER"
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]
Lang = Annotated[
    Language, typer.Option("--lang", help="Plug-ins without words in it are told in English.")
]


def faults(
    number: Number = None, *, as_json: AsJson = False, lang: Lang = Language.ENGLISH
) -> None:
    """All faults, installed packages' included, or one, with cause and remedy.

    All of them in a file or to a program are the page docs/faults.md, in Markdown.
    """
    found = known_faults()
    if number is not None:
        found = [fault for fault in found if fault.number == number]
        if not found:
            raise typer.BadParameter(_neighbours(number), param_hint="NUMBER")
    if as_json:
        plain = [_plain(fault, lang) for fault in found]
        typer.echo(json.dumps(plain, indent=2, ensure_ascii=False))
        return
    console = console_of_lines()
    if number is None and not console.is_terminal:
        typer.echo(catalogue_page(found, lang), nl=False)
        return
    for fault in found:
        _show(console, fault, lang)


def _plain(fault: type[CellError], language: Language) -> dict[str, str | int]:
    words = fault_words(fault, language)
    return {
        "number": fault.number,
        "text": words.text,
        "cause": words.cause,
        "remedy": words.remedy,
        "reaction": fault.reaction.value,
    }


def _show(console: Console, fault: type[CellError], language: Language) -> None:
    words = fault_words(fault, language)
    told = (words.cause, words.remedy, _reaction(fault, language))
    print_hanging(console, f"F{fault.number:03d} {words.text}", 5)
    for part, said in zip(_PARTS[language], told, strict=True):
        print_hanging(console, f"  {part}{said}", 2 + cell_len(part))


def _reaction(fault: type[CellError], language: Language) -> str:
    chinese = language is Language.CHINESE
    return _REACTIONS[fault.reaction] if chinese else fault.reaction.value


def _neighbours(number: int) -> str:
    """The numbers of the same hundred, among which the one that is meant may be."""
    near = [f"{one.number}" for one in known_faults() if one.number // 100 == number // 100]
    return f"there is no F{number:03d}; of its hundred: {', '.join(near) or 'none'}"


def catalogue_page(faults: Iterable[type[CellError]], language: Language = Language.ENGLISH) -> str:
    """A catalogue of these faults as Markdown."""
    title, introduction = _INTRODUCTIONS[language]
    lines = [title, "", introduction, "", _row(*_HEADS[language]), "|---|---|---|---|---|"]
    for fault in faults:
        words = fault_words(fault, language)
        number, reaction = f"F{fault.number:03d}", _reaction(fault, language)
        lines.append(_row(number, words.text, words.cause, words.remedy, reaction))
    return "\n".join(lines) + "\n"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
