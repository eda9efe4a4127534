"""The force of an insertion or an approach in the live view."""

from fakes.demo.demo import Message


def force_row(now: Message) -> str:
    """Force along the tool's axis, its peak and its limit, as far as the line PLC has them."""
    force, limit = now.get("force_z_n"), now.get("force_limit_n")
    peak = (now.get("force_peaks") or [None] * 3)[2]
    parts = ["-" if force is None else f"{force + 0.0:7.2f} N"]
    if peak is not None:
        parts.append(f"peak {peak:.1f} N")
    if limit is not None:
        parts.append(f"limit {limit:.0f} N")
    return "   ".join(parts)
