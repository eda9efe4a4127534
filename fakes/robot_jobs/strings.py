"""String words of the job language. Places count from 0, not found is -1: assumptions that the
installation sheet has verified, like the order of the arguments."""

from fakes.robot_jobs.lexer import JobError, Token
from fakes.robot_jobs.memory import Memory

WORDS = {
    "STRLEN", "STRFIND", "STRFINDEND", "STRSUB", "STRCMP", "STR2I", "STR2R", "I2STR",
}  # fmt: skip


def execute(word: str, found: tuple[Token, ...], memory: Memory) -> None:
    """Carry out one of ``WORDS``; raises ``JobError`` for a text that is no number."""
    if word == "I2STR":
        memory.set_string(found[1], str(int(memory.number(found[0], {}))))
        return
    text = memory.string(found[0])
    match word:
        case "STRLEN":
            result = float(len(text))
        case "STRFIND":
            result = float(text.find(memory.string(found[1])))
        case "STRFINDEND":
            result = float(text.rfind(memory.string(found[1])))
        case "STRSUB":
            first, length = (int(memory.number(token, {})) for token in found[1:3])
            memory.set_string(found[3], text[first : first + length])
            return
        case "STRCMP":
            other = memory.string(found[1])
            result = float((text > other) - (text < other))
        case _:
            result = _number(text)
    memory.set_number(found[-1], result, {})


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise JobError(f"no number: {text!r}") from None
