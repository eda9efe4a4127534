"""What operators read in Chinese: complete, made of today's English, with its figures and names."""

import pkgutil
import re
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

import cellctl.processes
from cellctl import fault_catalogue, plugins, translations
from cellctl.errors import CellError
from cellctl.fault_catalogue import known_fault, shipped_faults
from cellctl.processes.antenna_module.procedures.procedure_list import antenna_procedures
from cellctl.processes.deck_to_frame.procedures.procedure_list import deck_procedures
from cellctl.processes.peg_in_hole.procedures.procedure_list import peg_procedures
from cellctl.runtime.procedure import Procedure
from cellctl.runtime.steps import StepSpec
from cellctl.translations import fault_words, label, labels, of_english, spoken, translated
from tests.unit.test_fault_catalogue import FAULTS, install

FOREIGN = [language for language in translations.LANGUAGES if language != translations.ENGLISH]
PARTS = ("text", "cause", "remedy")
CONFIG = Path(__file__).parents[2] / "config"
CHINESE = re.compile("[\u4e00-\u9fff]")
_NAMES = re.compile(r"[A-Za-z][A-Za-z_]+")
_CODE = re.compile(r"`[^`]+`|--[a-z-]+|\w+_\w+|[\w/-]+\.md|\d+(?:\.\d+)?(?:e\d+)?")
_COMMAND = re.compile(r"`[^`]+`|(?:apt|cellctl) [a-z][\w .-]*|[\w-]*[_./-][\w./-]+")
KEPT = {"cellctl", "dh", "mm", "plan", "producer", "socket", "systemd"}
"""Words that an operator sees in this form on the device or in the file."""


def code(text: str) -> Counter[str]:
    """What is the same in every language: commands, keys, names of files, figures."""
    return Counter(_CODE.findall(text))


def amiss(fault: type[CellError], language: str) -> list[str]:
    """What a translator has to do about this fault."""
    entry = translated(fault.__module__, language).get(str(fault.number), {})
    if set(entry) != {*PARTS, "english"}:
        return ["is not translated: text, cause, remedy, english"]
    found = []
    if entry["english"] != of_english(fault):
        found.append(
            "the English has changed: see whether it is still what the translation says, correct "
            f'that, then write english = "{of_english(fault)}"'
        )
    for part in PARTS:
        english, foreign = getattr(fault, part), entry[part]
        if not CHINESE.search(foreign):
            found.append(f"{part} is not translated")
        if code(foreign) != code(english):
            found.append(f"{part} has other commands, keys or figures than the English")
        if strange := set(_NAMES.findall(foreign)) - set(
            _NAMES.findall(f"{fault.text} {fault.cause} {fault.remedy}")
        ):
            found.append(f"{part} has {sorted(strange)}, which the English has not")
        prose = {word for word in _NAMES.findall(_COMMAND.sub(" ", foreign)) if word.islower()}
        if prose - KEPT:
            found.append(f"{part} has {sorted(prose - KEPT)} in English")
    return found


@pytest.mark.parametrize("language", FOREIGN)
def test_every_fault_is_translated_as_it_is_today(language: str) -> None:
    found = {
        f"{fault.__module__.replace('.', '/')}.{language}.toml [{fault.number}]": problems
        for fault in shipped_faults()
        if (problems := amiss(fault, language))
    }
    assert found == {}


def test_a_translation_that_does_not_fit_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    fault = known_fault(212)
    assert fault is not None
    assert amiss(fault, "zh") == []
    monkeypatch.setattr(fault, "text", "Another text with 3 figures")
    assert [words.split()[0] for words in amiss(fault, "zh")] == ["the", "text"]


@pytest.mark.parametrize("language", FOREIGN)
def test_no_translation_has_lost_its_fault(language: str) -> None:
    for module in {fault.__module__ for fault in shipped_faults()}:
        numbers = {str(fault.number) for fault in shipped_faults() if fault.__module__ == module}
        assert set(translated(module, language)) == numbers, module


def _labels_of_steps() -> Iterator[str]:
    for found in pkgutil.walk_packages(cellctl.processes.__path__, "cellctl.processes."):
        if ".steps" in found.name or ".procedures" in found.name:
            module = vars(import_module(found.name))
            yield from (one.label for one in module.values() if isinstance(one, StepSpec))
            yield from ([module["LABEL"]] if "LABEL" in module else [])


def _procedures() -> Iterator[Procedure]:
    recipes = [cast(Any, SimpleNamespace(id=1))]
    settings = SimpleNamespace(validity_days=1, reference=object())
    devices = {"head_1": None, "head_2": None}
    cell = cast(Any, SimpleNamespace(settings=settings, recipes=recipes, **devices))
    nothing = cast(Any, None)
    for found in (
        deck_procedures(cell, nothing, nothing),
        antenna_procedures(cell, recipes, nothing),
        peg_procedures(cell, recipes, nothing),
    ):
        yield from found


@pytest.mark.parametrize("language", FOREIGN)
def test_every_step_and_procedure_has_a_label(language: str) -> None:
    steps, procedures = set(_labels_of_steps()), {one.label for one in _procedures()}
    assert {"mate", "grip again", "touch face"} <= steps
    assert {"identify payload", "tool by turning", "take panel reference"} <= procedures
    assert {one for one in steps | procedures if one not in labels(language)} == set()
    for english, foreign in labels(language).items():
        assert CHINESE.search(foreign), english
        assert code(english) == code(foreign)


def test_every_procedure_says_what_to_set_up_what_moves_and_what_it_renews() -> None:
    assert {one.number for one in _procedures() if not one.guide.set_up} == set()
    assert {one.number for one in _procedures() if not one.guide.moves} == set()
    assert {one.label for one in _procedures() if not one.guide.renews} == {"check main arm"}


AWAY = {
    "deck": ("The deck is taken out of the gripper.", "舱板"),
    "module": ("The gripper is empty.", "夹爪"),
    "plate": ("The reference plate is taken away.", "基准板"),
}
"""How a guide asks for a body to be away, and what the Chinese sentence has to name."""


def _away_in(table: Mapping[str, Any]) -> Iterator[tuple[str, int]]:
    """Bodies of a model, and each procedure before which a person takes them away."""
    for name, value in table.items():
        if isinstance(value, dict):
            yield from ((name, number) for number in value.get("absent_in", ()))
            yield from _away_in(value)


def test_guides_ask_for_the_bodies_to_be_taken_away_that_the_shipped_models_have_away() -> None:
    """Moves of such a procedure are held against the model without them."""
    guides = {one.number: one.guide for one in _procedures()}
    models = [tomllib.loads(path.read_text("utf-8")) for path in CONFIG.glob("*.model.toml")]
    away = {one for model in models for one in _away_in(model)}
    assert {("deck", 101), ("deck", 103), ("plate", 202), ("module", 201)} <= away
    assert {one for one in away if AWAY[one[0]][0] not in guides[one[1]].set_up} == set()
    assert {name for name, (line, word) in AWAY.items() if word not in label(line, "zh")} == set()
    asked = {number for number, guide in guides.items() if AWAY["deck"][0] in guide.set_up}
    assert asked == {number for name, number in away if name == "deck"}


@pytest.mark.parametrize("language", FOREIGN)
def test_every_sentence_of_a_guide_is_translated(language: str) -> None:
    guides = [one.guide for one in _procedures()]
    told = {line for one in guides for line in (*one.set_up, *one.moves, *one.then)}
    assert {line for line in told if label(line, language) == line} == set()


@pytest.mark.parametrize("language", FOREIGN)
def test_one_label_means_the_same_in_every_process(language: str) -> None:
    for point in plugins.installed(plugins.PROCESS):
        own = translated(f"{point.module.rpartition('.')[0]}.labels", language)
        assert own, f"{point.name} has no labels"
        assert {one for one, told in own.items() if labels(language)[one] != told} == set()


def test_progress_keeps_device_and_count() -> None:
    assert label("head_1: view 3 of 20", "zh") == f"head_1：{labels('zh')['view']} 3 / 20"
    assert label("axis A1: stop 2 of 4", "zh") == f"{labels('zh')['axis A1: stop']} 2 / 4"
    for unknown in ("mate", "another: word 1 of 2", ""):
        assert label(unknown, "en") == unknown
    assert label("another: word 1 of 2", "zh") == "another: word 1 of 2"


def test_a_fault_keeps_number_and_facts() -> None:
    lost, old = known_fault(202), known_fault(207)
    assert lost is not None
    assert old is not None
    told = str(lost(f"robot main: {old('0.31 s')}"))
    chinese = [fault_words(fault, "zh").text for fault in (lost, old)]
    assert spoken(told, "zh") == f"F202 {chinese[0]}：robot main: F207 {chinese[1]}：0.31 s"
    assert spoken(told, "en") == told
    for strange in ("F207 in words of long ago: 0.31 s", "F9999 nothing: 1", "no fault", ""):
        assert spoken(strange, "zh") == strange


def test_a_plug_in_is_told_in_english_unless_it_brings_its_own_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    install(tmp_path, "labels_told", FAULTS.format(number=1811))
    install(tmp_path, "labels_mute", FAULTS.format(number=1812))
    install(tmp_path, "labels_torn", FAULTS.format(number=1813))
    beside = tmp_path / "labels_told"
    (beside / "faults.zh.toml").write_text('[1811]\ntext = "标签歪斜"\n', "utf-8")
    (beside / "labels.zh.toml").write_text('"stick" = "贴标"\n', "utf-8")
    (tmp_path / "labels_torn" / "faults.zh.toml").write_text("[1813\n", "utf-8")
    forget()
    try:
        told, mute, torn = (known_fault(number) for number in (1811, 1812, 1813))
        assert told is not None
        assert mute is not None
        assert torn is not None
        assert fault_words(told, "zh").text == "标签歪斜"
        assert fault_words(told, "zh").cause == "The roll is worn."
        assert fault_words(mute, "zh").text == fault_words(torn, "zh").text == mute.text
        assert label("stick", "zh") == "贴标"
    finally:
        for name in [name for name in sys.modules if name.startswith("labels_")]:
            del sys.modules[name]
        monkeypatch.undo()
        forget()


def test_a_translation_of_other_english_is_not_told_and_its_digest_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    install(tmp_path, "labels_old", FAULTS.format(number=1814))
    words = '[1814]\ntext = "标签歪斜"\nenglish = "abcd"\n'
    (tmp_path / "labels_old" / "faults.zh.toml").write_text(words, "utf-8")
    forget()
    try:
        fault = known_fault(1814)
        assert fault is not None
        assert fault_words(fault, "zh").text == fault.text
        assert f'english = "{of_english(fault)}"' in caplog.text
        caplog.clear()
        fault_words(fault, "zh")
        assert caplog.text == "", "once is enough"
    finally:
        del sys.modules["labels_old"], sys.modules["labels_old.faults"]
        monkeypatch.undo()
        forget()


def forget() -> None:
    plugins.every.cache_clear()
    fault_catalogue.fault_modules.cache_clear()
    labels.cache_clear()
    translated.cache_clear()
