"""The words of the page: complete in each language, and without a claim that is not ours."""

import ast
import importlib
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl.fault_catalogue import known_fault
from cellctl.hmi.words.page_words import page_words
from cellctl.packml.command import COMMAND_NAMES
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import STATES

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "cellctl/hmi/page"
LANGUAGES = ("en", "zh")
OF_COMMANDS = {"_name(command)", "Command.ABORT.name.lower()"}
"""How the actions of commands are written, which have the words of their buttons."""
FORBIDDEN = {
    "en": ("emergency", "safe", "e-stop", "guarantee"),
    "zh": ("急停", "安全", "紧急"),
}


def texts(language: str) -> dict[str, str]:
    found: dict[str, str] = json.loads((PAGE / f"texts.{language}.json").read_text("utf-8"))
    return found


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_state_and_every_refusal_has_words(language: str) -> None:
    words = texts(language)
    wanted = {f"state_{state.name}" for state in STATES} | {f"next_{s.name}" for s in STATES}
    wanted |= {f"reject_{int(code)}" for code in RejectCode if code}
    assert wanted - set(words) == set()


def test_the_languages_have_the_same_words_with_the_same_places() -> None:
    english, chinese = texts("en"), texts("zh")
    assert set(english) == set(chinese)
    for key, text in english.items():
        assert sorted(re.findall(r"{\d}", text)) == sorted(re.findall(r"{\d}", chinese[key])), key


@pytest.mark.parametrize("language", LANGUAGES)
def test_manual_and_idle_ask_for_no_part(language: str) -> None:
    words = texts(language)
    assert words[f"next_IDLE_{Mode.MANUAL.name}"] != words["next_IDLE"]
    for mode in (Mode.PRODUCTION, Mode.MAINTENANCE):
        assert words[f"mode_{mode.name}"] in words[f"next_IDLE_{Mode.MANUAL.name}"]


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_control_is_called_a_safety_function(language: str) -> None:
    for key, text in texts(language).items():
        if key != "stale":  # which sends people to the device at the cell
            assert [word for word in FORBIDDEN[language] if word in text.lower()] == [], key


def test_every_word_that_the_page_asks_for_is_there() -> None:
    words = texts("en")
    code = "".join(path.read_text("utf-8") for path in PAGE.glob("*.js"))
    asked = set(re.findall(r'\bt\("(\w+)"', code))
    assert len(asked) > 80
    assert asked - set(words) == set()


def _written_actions() -> Iterator[str]:
    """Every action that a call of this product writes into the audit log, but for commands."""
    for path in sorted((ROOT / "cellctl").rglob("*.py")):
        for call in ast.walk(ast.parse(path.read_text("utf-8"))):
            action = _action(call)
            if isinstance(action, ast.Constant):
                yield str(action.value)
            elif isinstance(action, ast.Name):
                module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
                yield getattr(importlib.import_module(module), action.id)
            elif action is not None:
                assert ast.unparse(action) in OF_COMMANDS, path


def _action(call: ast.AST) -> ast.expr | None:
    """Of ``store.audit(actor, action, …)`` and ``do(RunStore.audit, actor, action, …)``."""
    if not isinstance(call, ast.Call):
        return None
    if isinstance(call.func, ast.Attribute) and call.func.attr == "audit" and len(call.args) > 1:
        return call.args[1]
    named = [ast.unparse(argument) for argument in call.args]
    return call.args[2] if named[:1] == ["RunStore.audit"] else None


def test_every_action_of_the_audit_log_has_words() -> None:
    written = set(_written_actions())
    assert {"calibration stored", "calibrations sealed", "note"} <= written
    for language in LANGUAGES:
        words = texts(language)
        assert {f"audit_{action}" for action in written} - set(words) == set()
        # A line PLC may also give those that have no button: they are refused, which is written.
        for name in COMMAND_NAMES.values():
            assert {f"cmd_{name}", f"audit_{name}"} & set(words), name


def test_the_page_is_given_the_words_of_faults_and_labels_besides_its_own() -> None:
    fault = known_fault(207)
    assert fault is not None
    served = page_words("zh")
    assert served["english_207"] == fault.text
    assert served["fault_207"] not in ("", fault.text)
    assert {"cause_207", "remedy_207", "label_mate", "label_identify payload"} <= set(served)
    assert served.items() >= texts("zh").items(), "its own words come first"
    assert page_words("en") == texts("en")


def test_the_page_names_no_process_and_no_device() -> None:
    code = "".join(path.read_text("utf-8") for path in PAGE.iterdir()).lower()
    for word in ("deck", "antenna", "frame_", "peg", "siasun", "head_1", "pin hole"):
        assert word not in code
