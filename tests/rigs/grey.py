"""Reads a drawing as a grey print shows it: without its colours."""

import re
from collections.abc import Iterator
from xml.etree import ElementTree as ET

_STROKE = re.compile(r"(?<![\w-])stroke: (#[0-9a-f]{6})")
_WIDTH = re.compile(r"stroke-width: ([\d.]+)")
_DASHES = re.compile(r"stroke-dasharray: ([\d., ]+)")
_LINK = "{http://www.w3.org/1999/xlink}href"


def confusable(svg: str) -> list[set[str]]:
    """Colours of lines and markers that have one shape, and so cannot be told apart in grey.

    Axes, grids and letters are grey themselves and are left out.
    """
    colours: dict[object, set[str]] = {}
    for shape, colour in _drawn(ET.fromstring(svg)):
        colours.setdefault(shape, set()).add(colour)
    return [found for found in colours.values() if len(found) > 1]


def _drawn(root: ET.Element) -> Iterator[tuple[object, str]]:
    """Shape and colour of everything coloured."""
    # A marker's name depends on its colour, its outline does not.
    outlines = {f"#{one.get('id')}": one.get("d") for one in root.iter() if one.get("id")}
    for element in root.iter():
        style = element.get("style", "")
        stroke = _STROKE.search(style)
        if stroke is None or not _coloured(stroke[1]):
            continue
        tag = element.tag.rsplit("}", 1)[-1]
        if tag == "use":
            yield ("marker", outlines[element.get(_LINK, "")]), stroke[1]
        elif tag == "path" and "fill: none" in style:
            yield ("line", _pattern(style)), stroke[1]


def _pattern(style: str) -> tuple[float, ...]:
    """Dashes and gaps as multiples of the width of the line; empty for one without gaps."""
    found, width = _DASHES.search(style), _WIDTH.search(style)
    if found is None:
        return ()
    scale = float(width[1]) if width else 1.0
    return tuple(round(float(text) / scale, 2) for text in found[1].split(","))


def _coloured(colour: str) -> bool:
    parts = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return max(parts) - min(parts) > 40
