"""What the page says in each language: its own words, and those of faults and labels.

Keys as the scripts of the page use them: ``fault_207``, ``cause_207``, ``remedy_207``,
``label_mate``; ``english_207`` is the text by which the page finds a fault in what the daemon says.
"""

import json
from collections.abc import Mapping
from functools import cache
from importlib import resources

from cellctl.fault_catalogue import known_faults
from cellctl.translations import ENGLISH, fault_words, labels


@cache
def page_words(language: str) -> Mapping[str, str]:
    """All of them. In English there are only the page's own: the daemon says the others."""
    file = resources.files("cellctl.hmi").joinpath("page", f"texts.{language}.json")
    words: dict[str, str] = json.loads(file.read_text("utf-8"))
    if language == ENGLISH:
        return words
    for fault in known_faults():
        told = fault_words(fault, language)
        if told.text == fault.text:
            continue
        words[f"english_{fault.number}"] = fault.text
        words[f"fault_{fault.number}"] = told.text
        words[f"cause_{fault.number}"] = told.cause
        words[f"remedy_{fault.number}"] = told.remedy
    return words | {f"label_{english}": told for english, told in labels(language).items()}


def refusal(code: int, english: str, language: str) -> str:
    """Why a command was refused."""
    if language == ENGLISH:
        return english
    return page_words(language).get(f"reject_{int(code)}", english)
