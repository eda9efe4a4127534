"""The name in a Host header."""


def host_name(header: str) -> str:
    """Without port and brackets: ``[::1]:8080`` is ``::1``."""
    if header.startswith("["):
        return header.partition("]")[0].removeprefix("[")
    return header.partition(":")[0]
