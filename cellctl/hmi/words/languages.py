"""Which language an answer of the API has: what ``Accept-Language`` asks for (RFC 9110, 12.5.4)."""

from typing import Annotated

from fastapi import Depends, Request, Response

from cellctl.translations import ENGLISH, LANGUAGES


def preferred(accepted: str) -> str:
    """The language of ours that the header likes best, ``zh-CN`` being ``zh``; else English."""
    best, found = 0.0, ENGLISH
    for one in accepted.split(","):
        tag, _, parameters = one.strip().partition(";")
        language = tag.strip().lower().partition("-")[0]
        weight = _weight(parameters)
        # Of two that are liked alike the one that is named first.
        if language in LANGUAGES and weight > best:
            best, found = weight, language
    return found


def _weight(parameters: str) -> float:
    name, _, value = parameters.strip().partition("=")
    if name.strip().lower() != "q":
        return 1.0
    try:
        return float(value)
    except ValueError:
        return 0.0


def language_of(request: Request) -> str:
    """The language that this request asks for."""
    return preferred(request.headers.get("accept-language", ""))


def headers_of(language: str) -> dict[str, str]:
    """Headers of an answer whose words depend on the language."""
    return {"Content-Language": language, "Vary": "Accept-Language"}


def _told_in(request: Request, response: Response) -> str:
    language = language_of(request)
    response.headers.update(headers_of(language))
    return language


Language = Annotated[str, Depends(_told_in)]
"""For routes: the language of the answer, which its headers say."""
