"""The documents as a reader uses them: every command exists, every link leads somewhere."""

import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import click
import pytest
import typer
from typer.testing import CliRunner

from cellctl.api.modbus.document import register_map_document
from cellctl.cli.commands import whole_app
from cellctl.cli.faults import catalogue_page
from cellctl.fault_catalogue import shipped_faults
from cellctl.hmi.main import app as page_app
from cellctl.packml.document import state_machine_document
from fakes.__main__ import app as fakes_app
from fakes.demo.app import app as demo_app
from fakes.wire.line.plc import app as plc_app

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    path
    for path in (
        *ROOT.glob("*.md"),
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / "fakes").rglob("*.md"),
        *(ROOT / "drivers").rglob("*.md"),
    )
)
_LINK = re.compile(r"(?<!!)\[[^\]]+\]\(([^)\s]+)\)|!\[[^\]]*\]\(([^)\s]+)\)")
_FENCE = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
_INLINE = re.compile(r"`([^`\n]+)`")
_PATH = re.compile(r"(?:cellctl|drivers|fakes|benchmarks|tests|systemd)/[\w./-]+")
_PROGRAMS = ("make ", "cellctl ", "cellctl-hmi ", "python -m ", ".venv/bin/")
_SETTING = re.compile(r"[A-Z]+=.+")


@dataclass(frozen=True)
class Written:
    """A command in a document."""

    page: Path
    text: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}: {self.text}"


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def commands() -> Iterator[Written]:
    """Lines of code blocks and inline code that begin with one of our programs."""
    for page in PAGES:
        text = re.sub(r"\\\n *", "", page.read_text(encoding="utf-8"))
        fenced = [line for block in _FENCE.findall(text) for line in block.splitlines()]
        indented = [line[4:] for line in text.splitlines() if line.startswith("    ")]
        for line in (*fenced, *indented, *_INLINE.findall(_FENCE.sub("", text))):
            command = line.strip().removeprefix("$ ").split("  #")[0].split(" # ")[0].strip()
            if command.startswith(_PROGRAMS) and "─" not in command:
                yield Written(page, command.removeprefix(".venv/bin/"))


def targets() -> set[str]:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    return set(re.findall(r"^([a-z-]+):(?!=)", makefile, re.MULTILINE))


def options_exist(app: typer.Typer | click.Command, words: list[str]) -> None:
    """Walks down to the sub-command; every option written is one of its options."""
    command: Any = typer.main.get_command(app) if isinstance(app, typer.Typer) else app
    if hasattr(command, "list_commands"):
        if not words or words[0].isupper() or words[0].startswith(("-", "…", "[")):
            return
        subcommand = command.get_command(None, words[0])
        assert subcommand is not None, f"no sub-command {words[0]!r}"
        options_exist(subcommand, words[1:])
        return
    known = {option for parameter in command.params for option in parameter.opts}
    for word in words:
        option = word.strip("[]").split("=")[0]
        if option.startswith("--"):
            assert option in known | {"--help"}, f"no option {option!r} in {sorted(known)}"
    if len(words) > 1:  # not only mentioned
        missing = [p.opts[-1] for p in command.params if p.required and p.opts[-1] not in words]
        assert not [option for option in missing if option.startswith("--")]


@cache
def study_help() -> str:
    """Help of the program to which `cellctl study` hands on; a process of its own must load it."""
    done = subprocess.run(
        [sys.executable, "-m", "cellctl", "study", "--help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def exists(written: Written) -> None:
    """Fails for a command that does not."""
    words = shlex.split(written.text.replace("…", ""))
    if words[0] == "make":
        assert words[1] in targets()
        assert all(_SETTING.fullmatch(word) for word in words[2:])
    elif words[0] == "cellctl":
        app = demo_app if words[1:2] == ["demo"] else whole_app()
        if words[1:2] == ["study"]:
            explained = study_help()
            unknown = [word for word in words if word.startswith("-") and word not in explained]
            assert unknown == []
            return
        options_exist(app, words[2:] if app is demo_app else words[1:])
    elif words[0] == "cellctl-hmi":
        options_exist(page_app, words[1:])
    elif words[:3] == ["python", "-m", "fakes"]:
        inner = {"demo": demo_app, "plc": plc_app}.get(words[3] if len(words) > 3 else "")
        options_exist(inner or fakes_app, words[4:] if inner else words[3:])
    elif words[:3] == ["python", "-m", "pytest"]:
        assert all((ROOT / word).exists() for word in words[3:] if not word.startswith("-"))
    elif words[:2] == ["python", "-m"]:
        module = ROOT.joinpath(*words[2].split("."))
        assert module.with_suffix(".py").is_file() or (module / "__main__.py").is_file()


def test_every_command_exists() -> None:
    written = {str(command): command for command in commands()}
    pages = {command.page.name for command in written.values()}
    assert {"README.md", "operating.md", "commissioning.md"} <= pages
    assert len(written) > 20
    wrong: dict[str, str] = {}
    for place, command in sorted(written.items()):
        try:
            exists(command)
        except AssertionError as error:
            wrong[place] = str(error)
    assert wrong == {}


def test_links_lead_somewhere() -> None:
    assert [problem for page in PAGES for problem in wrong_links(page)] == []


def wrong_links(page: Path) -> Iterator[str]:
    text = _FENCE.sub("", page.read_text(encoding="utf-8"))
    for match in _LINK.finditer(text):
        target = match[1] or match[2]
        if target.startswith(("http://", "https://", "mailto:")):
            continue
        path, _, heading = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        if ROOT not in file.parents:
            yield f"{name(page)} links out of the repository: {target}"
        elif not file.exists() or (heading and heading not in headings(file)):
            yield f"{name(page)} links to {target}"


def headings(page: Path) -> set[str]:
    """Anchors as hosting sites make them."""
    lines = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in lines}


def test_every_page_can_be_found() -> None:
    """Links lead from the README to every page, or to the folder that holds it."""
    reached: set[Path] = set()
    waiting = [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        if page in reached:
            continue
        reached.add(page)
        if page.is_dir():
            waiting += page.glob("*.md")
            continue
        for match in _LINK.finditer(page.read_text(encoding="utf-8")):
            target = (page.parent / (match[1] or match[2]).split("#")[0]).resolve()
            if target.is_dir() or target.suffix == ".md":
                waiting.append(target)
    docs = set((ROOT / "docs").rglob("*.md"))
    assert {name(page) for page in docs - reached} == set()


def test_generated_pages_are_new() -> None:
    docs = ROOT / "docs"
    assert (docs / "faults.md").read_text(encoding="utf-8") == catalogue_page(shipped_faults())
    assert (docs / "register-map.md").read_text(encoding="utf-8") == register_map_document()
    assert (docs / "state-machine.md").read_text(encoding="utf-8") == state_machine_document()


def test_cheap_commands_run() -> None:
    runner = CliRunner()
    for arguments in (
        ["check", str(ROOT / "config" / "deck.toml")],
        ["faults"],
    ):
        done = runner.invoke(whole_app(), arguments)
        assert done.exit_code == 0, (arguments, done.output)


APPS: dict[str, Callable[[], typer.Typer]] = {
    "cellctl": whole_app,
    "fakes": lambda: fakes_app,
    "demo": lambda: demo_app,
    "plc": lambda: plc_app,
}


@pytest.mark.parametrize("program", APPS)
def test_every_command_explains_itself(program: str) -> None:
    app = APPS[program]()

    def explain(command: Any, path: list[str]) -> None:
        children = command.list_commands(None) if hasattr(command, "list_commands") else ()
        for child in children:
            explain(command.get_command(None, child), [*path, child])
        if "help_option_names" not in command.context_settings:  # those hand on to another program
            done = runner.invoke(app, [*path, "--help"])
            assert done.exit_code == 0, done.output
            assert command.help, f"{path} has no words of help"

    runner = CliRunner()
    explain(typer.main.get_command(app), [])


def test_every_file_that_is_named_exists() -> None:
    missing = [
        f"{name(page)}: {text}"
        for page in PAGES
        for text in _INLINE.findall(_FENCE.sub("", page.read_text(encoding="utf-8")))
        if _PATH.fullmatch(text) and not (ROOT / text).exists()
    ]
    assert missing == []


def test_every_place_on_the_architecture_page_exists() -> None:
    # The page leaves the name of the package out; names that stand for any are in <angles>.
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    named = [one for one in _INLINE.findall(text) if re.fullmatch(r"[a-z_]+/[\w./]*", one)]
    homes = (ROOT, ROOT / "cellctl", *(ROOT / "cellctl" / "processes").glob("*/"))
    missing = [one for one in named if not any((home / one).exists() for home in homes)]
    assert len(named) > 40
    assert missing == []


def test_every_test_that_is_named_exists() -> None:
    tests = "\n".join(path.read_text("utf-8") for path in (ROOT / "tests").rglob("*.py"))
    known = set(re.findall(r"def (test_\w+)\(", tests))
    named = {
        text
        for page in PAGES
        for text in _INLINE.findall(page.read_text(encoding="utf-8"))
        if re.fullmatch(r"test_\w+", text)
    }
    assert len(named) > 20
    assert named - known == set()
