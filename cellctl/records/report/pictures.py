"""Sorts the pictures of a run into groups."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from cellctl.records.units import words

_OF_A_HEAD = re.compile(r"(?P<title>.+)-head-(?P<head>\d+)-(?P<side>left|right)\.\w+")
"""``frame-head-1-left.jpg``: what a stereo head saw."""


@dataclass(frozen=True, slots=True)
class PictureGroup:
    """Pictures that belong together."""

    title: str
    pictures: tuple[tuple[str, str], ...]
    """Caption and address."""


def picture_groups(addresses: Mapping[str, str]) -> tuple[PictureGroup, ...]:
    """Pictures of stereo heads by what they show; all others in a group of their own."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for name, address in addresses.items():
        match = _OF_A_HEAD.fullmatch(name)
        title = words(match["title"].replace("-", "_")) if match else "other"
        caption = f"head {match['head']}, {match['side']}" if match else name
        groups.setdefault(title, []).append((caption, address))
    return tuple(PictureGroup(title, tuple(pictures)) for title, pictures in groups.items())
