"""Plain data that carries the SHA-256 of its own content as its ``id``.

A calibration is kept so (``calibration.store.envelope``): around the ``record`` of a result stand
``format``, dates and serial number, and the id is the hash of all of them.
"""

import hashlib
import json
from collections.abc import Mapping
from typing import Any


def content_id(content: Mapping[str, Any]) -> str:
    """SHA-256 of plain data in canonical JSON."""
    # One text for one content, whatever the order of its keys. NaN is refused, because JSON of
    # other programs could not read it.
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def fits_its_id(content: Mapping[str, Any]) -> bool:
    """Whether nothing was changed since the id was made."""
    # As it stands in the file, so that a field which nobody reads cannot be changed either.
    rest = {key: value for key, value in content.items() if key != "id"}
    return content_id(rest) == content.get("id")


def record_within(content: Any) -> Any:
    """The record of a stored calibration; anything else as it is.

    So a command takes the file of a calibration from the folder of a cell as it takes the result of
    an offline command. Raises ``ValueError`` for a stored one that was changed.
    """
    if not (isinstance(content, dict) and {"format", "id", "record"} <= content.keys()):
        return content
    if not fits_its_id(content):
        raise ValueError("content does not match its id; it was changed")
    return content["record"]
