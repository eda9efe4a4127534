"""Records as JSON for programs: times as ISO 8601 in UTC, names of states as words."""

import json
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any


def as_plain(content: Mapping[str, Any] | Sequence[Any]) -> str:
    """The text; indented, for people read it too."""
    return json.dumps(content, indent=2, ensure_ascii=False, default=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, datetime):
        return value.isoformat()
    return dict(value) if isinstance(value, Mapping) else str(value)
