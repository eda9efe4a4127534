"""Faults and labels in the languages of operators, from files beside their English.

English stands in the code. ``force.zh.toml`` beside ``force.py`` has the Chinese of its faults, by
number; ``labels.zh.toml`` in the package of a process has that of the labels of its steps and
procedures, and of what they tell of their progress, by their English. What has no such file, as
most plug-ins, is told in English.
"""

import hashlib
import logging
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

from cellctl import plugins
from cellctl.errors.base import CellError
from cellctl.fault_catalogue import known_fault

log = logging.getLogger(__name__)

ENGLISH = "en"
LANGUAGES = (ENGLISH, "zh")
_COLON = {"zh": "："}
_NUMBERED = re.compile(r"\bF(\d{3,}) ")
_COUNT = re.compile(r" (\d+) of (\d+)$")


@dataclass(frozen=True, slots=True)
class FaultWords:
    """What an operator reads of a fault, without the facts of an occurrence."""

    text: str
    cause: str
    remedy: str


def fault_words(fault: type[CellError], language: str) -> FaultWords:
    """In this language; in English where nobody has translated them."""
    found = translated(fault.__module__, language).get(str(fault.number))
    if found is None or not _of_today(fault, language, str(found.get("english", ""))):
        return FaultWords(fault.text, fault.cause, fault.remedy)
    english = {"text": fault.text, "cause": fault.cause, "remedy": fault.remedy}
    return FaultWords(**{part: found.get(part, words) for part, words in english.items()})


def label(english: str, language: str) -> str:
    """Of a step, a procedure or its progress; the English one where nobody has translated it.

    Of ``head_1: view 3 of 20`` only ``view`` is translated: device and count stay as they are.
    """
    known = labels(language)
    count = _COUNT.search(english)
    words = english[: count.start()] if count else english
    device, colon, rest = ("", "", words) if words in known else words.rpartition(": ")
    if rest not in known:
        return english
    begin = f"{device}{_COLON[language]}" if colon else ""
    return f"{begin}{known[rest]}" + (f" {count[1]} / {count[2]}" if count else "")


def spoken(text: str, language: str) -> str:
    """``F207 Data from a device is too old: facts`` in this language; the facts stay as they are.

    Also where one fault is told in the facts of another. A fault in other words than today's, as an
    old record may have them, stays as it is.
    """
    head = None if language == ENGLISH else _NUMBERED.search(text)
    if head is None:
        return text
    begin, told = text[: head.end()], text[head.end() :]
    fault = known_fault(int(head[1]))
    if fault is None or not told.startswith(fault.text):
        return begin + spoken(told, language)
    facts = told.removeprefix(fault.text)
    if facts.startswith(": "):
        facts = _COLON[language] + facts.removeprefix(": ")
    return begin + fault_words(fault, language).text + spoken(facts, language)


def of_english(fault: type[CellError]) -> str:
    """Digest of the English words: a translation says which ones it was made of."""
    words = "\n".join((fault.text, fault.cause, fault.remedy))
    return hashlib.sha256(words.encode()).hexdigest()[:8]


def _of_today(fault: type[CellError], language: str, english: str) -> bool:
    """Whether a translation was made of these English words. One of others may say the contrary of
    what is to be done; one that does not say is believed."""
    if english == of_english(fault):
        return True
    made = f"made of other English words ({english})" if english else "not said of which English"
    remedy = f'once it fits, write english = "{of_english(fault)}"'
    _warn_once(f"{language} of F{fault.number} in {fault.__module__}: {made}; {remedy}")
    return not english


@cache
def _warn_once(what: str) -> None:
    log.warning("%s", what)


@cache
def labels(language: str) -> Mapping[str, str]:
    """Of the steps and procedures of all installed processes, by the English ones."""
    found = dict(translated("cellctl.procedures.labels", language))
    for point in plugins.installed(plugins.PROCESS):
        package = point.module.rpartition(".")[0]
        if package:
            found |= translated(f"{package}.labels", language)
    return found


@cache
def translated(module: str, language: str) -> Mapping[str, Any]:
    """What the file of this language beside a module holds; nothing when there is none."""
    package, _, name = module.rpartition(".")
    # A module outside any package has no place for such a file.
    if language == ENGLISH or not package:
        return {}
    try:
        text = resources.files(package).joinpath(f"{name}.{language}.toml").read_text("utf-8")
        return tomllib.loads(text)
    except FileNotFoundError:
        return {}
    # A plug-in that is damaged must not keep the operator from reading everybody else's words.
    except (ImportError, OSError, ValueError) as error:
        log.warning("%s of %s cannot be read: %s", language, module, error)
        return {}
