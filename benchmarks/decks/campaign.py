"""The campaign: `python -m benchmarks.decks.campaign`.

Exit codes: 0 no deck was called good that is not, 1 one was, 130 interrupted.
"""

import json
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from fnmatch import fnmatch
from itertools import product
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, Any

import cv2
import typer
from rich.console import Console

from benchmarks.decks.chain import Figures, Outcome, Shipped, run_chain
from benchmarks.decks.deck_range import DECKS, LARGE_LEGS_MM, SHIPPED_LEGS_MM, Deck, refusals
from benchmarks.decks.table import document, markdown

INTERRUPTED = 130


def campaign(
    n: Annotated[int, typer.Option("-n", min=1, help="Seeds of every deck.")] = 3,
    page: Annotated[
        Path, typer.Option(help="Where the table goes as Markdown; its figures beside it.")
    ] = Path("runs/decks.md"),
    workers: Annotated[int, typer.Option(min=1, help="Processes.")] = 2,
    only: Annotated[
        list[str] | None,
        typer.Option(help="Decks, as 10kg-1x1m-150mm, with * as in file names; may repeat."),
    ] = None,
) -> None:
    """Assemble every deck of the range; whose figures lie beside the page is not run again."""
    console = Console(highlight=False, soft_wrap=True)
    page.parent.mkdir(parents=True, exist_ok=True)
    file = page.with_suffix(".json")
    rows: dict[str, dict[str, Any]] = (
        json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    )
    decks = tuple(
        deck for deck in _all_decks() if any(fnmatch(deck.key, one) for one in only or ("*",))
    )
    waiting = [
        (deck, seed)
        for seed, deck in product(range(1, n + 1), decks)
        if f"{deck.key}/{seed}" not in rows
    ]
    code = 0
    pool = ProcessPoolExecutor(workers, get_context("spawn"), initializer=_one_thread)
    try:
        for done, figures in enumerate(pool.map(_run, waiting), start=1):
            rows[f"{figures.deck}/{figures.seed}"] = figures.row()
            file.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
            console.print(f"{done} of {len(waiting)}: {_told(figures)}")
    except KeyboardInterrupt:
        console.print("interrupted; the same command goes on from here", style="bold")
        code = INTERRUPTED
    finally:
        pool.shutdown(cancel_futures=True)
    shipped = Shipped.read()
    refused = {deck.key: refusals(deck, shipped.setting) for deck in decks}
    results = [Figures.of(row) for row in rows.values()]
    page.write_text(document(decks, results, refused), encoding="utf-8")
    console.print(markdown(decks, results, refused))
    false = any(row["outcome"] == Outcome.FALSE for row in rows.values())
    raise typer.Exit(code or int(false))


def _all_decks() -> Iterator[Deck]:
    for deck, legs in product(DECKS, (SHIPPED_LEGS_MM, LARGE_LEGS_MM)):
        yield replace(deck, legs_mm=legs)


def _one_thread() -> None:
    cv2.setNumThreads(1)


def _run(case: tuple[Deck, int]) -> Figures:
    return run_chain(case[0], Shipped.read(), case[1])


def _told(figures: Figures) -> str:
    known: Sequence[str] = [
        f"{name} {value:.3f}"
        for name, value in figures.row().items()
        if isinstance(value, float) and name.endswith(("mm", "_n", "deg"))
    ]
    text = f" ({figures.text})" if figures.text else ""
    return f"{figures.deck}, seed {figures.seed}: {figures.outcome}{text}; {', '.join(known)}"


if __name__ == "__main__":
    typer.run(campaign)
