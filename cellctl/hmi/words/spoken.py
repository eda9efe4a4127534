"""What the daemon says, in the language of whoever asks the API; in English it is left as it is.

The stream of events stays as the daemon pushes it, the same bytes for everybody: the page
translates by itself (``texts.js``).
"""

from collections.abc import Mapping
from typing import Any

from cellctl.fault_catalogue import known_fault
from cellctl.hmi.words.page_words import refusal
from cellctl.translations import ENGLISH, fault_words, label, spoken

Message = Mapping[str, Any]


def snapshot_in(language: str, snapshot: Message) -> dict[str, Any]:
    """Faults, alarms, links, step and what is permitted."""
    told = dict(snapshot)
    if language == ENGLISH:
        return told
    for kind in ("faults", "alarms"):
        told[kind] = [_fault_in(language, one) for one in snapshot.get(kind, ())]
    told["links"] = {
        name: spoken(said, language) for name, said in snapshot.get("links", {}).items()
    }
    step = snapshot.get("step", {})
    told["step"] = step | {key: label(step.get(key, ""), language) for key in ("label", "text")}
    told["permitted"] = permitted_in(language, snapshot.get("permitted", {}))
    return told


def permitted_in(language: str, permitted: Message) -> dict[str, Any]:
    """The reason why not, by command."""
    return {
        name: one | {"reason": refusal(one["code"], one["reason"], language)}
        for name, one in permitted.items()
    }


def description_in(language: str, description: Message) -> dict[str, Any]:
    """Names of the procedures, and what is the matter with calibrations."""
    told = dict(description)
    if "procedures" in description:
        told["procedures"] = [_procedure_in(language, one) for one in description["procedures"]]
    if "calibrations" in description:
        told["calibrations"] = [
            one | {"problem": spoken(one["problem"], language)}
            for one in description["calibrations"]
        ]
    return told


def _procedure_in(language: str, one: Message) -> dict[str, Any]:
    guide = {
        part: [label(sentence, language) for sentence in one.get(part, ())]
        for part in ("set_up", "moves", "then")
    }
    return {**one, "name": label(one["name"], language), **guide}


def run_in(language: str, run: Message) -> dict[str, Any]:
    """The fault that a run ended with, and its steps."""
    told = dict(run)
    if run["head"]["fault"]:
        told["head"] = run["head"] | {"fault": spoken(run["head"]["fault"], language)}
    told["phases"] = [one | {"label": label(one["label"], language)} for one in run["phases"]]
    return told


def _fault_in(language: str, one: Message) -> dict[str, Any]:
    told = {**one, "text": spoken(one["text"], language)}
    fault = known_fault(one["number"])
    if fault is None:
        return told
    words = fault_words(fault, language)
    # Somebody else's fault of this number, or one in other words, is not this one.
    for part, english, foreign in (
        ("cause", fault.cause, words.cause),
        ("remedy", fault.remedy, words.remedy),
    ):
        if one[part] == english:
            told[part] = foreign
    return told
