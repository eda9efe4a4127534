"""Pictures of the screens, of a fake cell at work: `python -m benchmarks.page.pictures`.

By itself those of the documentation: one size, English.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from benchmarks.page.person import Person, chromium
from fakes.demo.page import write_settings
from tests.rigs.whole_cell.own_cell import ROOT, OwnCell

SIZES = ("1280x800", "1080x1920", "1024x600")
DOCUMENTED = ("run", "maintenance", "aborted", "alarms", "history", "calibration", "line", "health")
"""Those that the documentation shows, besides the dialog of Start."""


@dataclass
class Camera:
    """Takes each picture in every size and language that is wanted."""

    person: Person
    folder: Path
    sizes: tuple[str, ...]
    languages: tuple[str, ...]
    names: tuple[str, ...] = ()
    """Of those that are wanted; empty for all."""

    def take(self, name: str, screen: str) -> None:
        if self.names and name not in self.names:
            return
        for language in self.languages:
            self._speak(language)
            for size in self.sizes:
                width, height = size.split("x")
                self.person.tab.set_viewport_size({"width": int(width), "height": int(height)})
                self.person.show(screen, self.folder / self._file(name, size, language))
        self._speak(self.languages[0])

    def _file(self, name: str, size: str, language: str) -> str:
        marks = [size] * (len(self.sizes) > 1) + [language] * (len(self.languages) > 1)
        return "-".join(("page", name, *marks)) + ".png"

    def _speak(self, language: str) -> None:
        if self.person.tab.evaluate("document.documentElement.lang") != language:
            self.person.tab.click("#language")
            self.person.tab.wait_for_selector(f"html[lang={language}]")


def main(
    out: Annotated[Path, typer.Option(help="Folder.")] = ROOT / "docs" / "pictures",
    *,
    every: Annotated[bool, typer.Option(help="All sizes, both languages.")] = False,
) -> None:
    """Run a fake cell through a part, a procedure and a fault, and picture every screen."""
    out.mkdir(parents=True, exist_ok=True)
    sizes, languages = (SIZES, ("en", "zh")) if every else (SIZES[:1], ("en",))
    names = () if every else DOCUMENTED
    with tempfile.TemporaryDirectory() as folder:
        own = OwnCell.make(Path(folder))
        try:
            own.fake().ready()
            own.daemon().ready()
            settings, own.pin = write_settings(own.folder)
            # On a busy computer a part takes longer than a session lasts that nobody uses.
            text = settings.read_text("utf-8").replace("port = 0", "port = 0\nidle_s = 3600")
            settings.write_text(text, "utf-8")
            url = str(own.page(settings).ready()["url"])
            with chromium() as browser:
                context = browser.new_context(
                    locale="en-GB", timezone_id="Europe/Berlin", reduced_motion="reduce"
                )
                person = Person(context.new_page(), url, own.pin)
                _through(own, Camera(person, out, sizes, languages, names))
        finally:
            own.kill_all()


def _through(own: OwnCell, camera: Camera) -> None:
    person = camera.person
    person.to_idle()
    camera.take("idle", "run")
    person.tab.set_viewport_size({"width": 1280, "height": 800})
    person.tab.click("#cmd-start")
    person.tab.fill("#serial", "SAT-0042")
    person.tab.screenshot(path=camera.folder / "page-start.png")
    person.tab.keyboard.press("Escape")
    with own.control() as control:
        control.request("load")
    person.command("start", serial="SAT-0042", recipe="1")
    person.until("mating", lambda one: one["step"]["label"] == "mate")
    person.until("contact", _presses)
    camera.take("run", "run")
    person.until("end", lambda one: one["state"] == "COMPLETED")
    camera.take("completed", "run")
    run = person.status()["run"]["number"]
    camera.take("runs", "history")
    camera.take("history", f"history/{run}")
    _procedure(own, camera)
    _fault(own, camera)
    for screen in ("calibration", "maintenance", "line", "health"):
        name = {"maintenance": "procedures"}.get(screen, screen)
        camera.take(name, screen)


def _presses(status: dict[str, Any]) -> bool:
    forces = [one["value"] for force in status["forces"] for one in force["wrench"]]
    return any(value is not None and abs(value) > 5.0 for value in forces)


def _procedure(own: OwnCell, camera: Camera) -> None:
    person = camera.person
    person.to_idle()
    with own.control() as control:
        # A calibration moves arms through the room of the deck, and refuses one that is gripped.
        control.request("present", frame=False, deck=False)
        control.request("place_chessboard", head="head_1", number=1)
    person.command("mode", mode="maintenance")
    camera.take("set-up", "maintenance/101")
    person.command("procedure", number=101, serial="PROCEDURE-101")
    person.until("views", lambda one: "view 4" in one["step"]["text"])
    camera.take("maintenance", "maintenance/101")
    person.command("stop", "STOPPED")
    camera.take("result", "maintenance/101")
    person.to_idle()
    with own.control() as control:
        control.request("remove_boards")
    person.command("mode", mode="production")


def _fault(own: OwnCell, camera: Camera) -> None:
    person = camera.person
    with own.control() as control:
        control.request("load")
        person.command("start", serial="SAT-0043", recipe="1")
        person.until("motion", lambda one: one["step"]["number"] > 0)
        control.request("inject", device="head_1", name="silent")
    person.until("fault", lambda one: one["state"] == "ABORTED", faults=True)
    camera.take("aborted", "run")
    camera.take("alarms", "alarms")


if __name__ == "__main__":
    typer.run(main)
