"""What goes wrong with a camera, in the process of the maker's library."""

from collections.abc import Iterator
from contextlib import contextmanager

from genicam import genapi, gentl

from drivers.camera.gige.protocol import Trouble

# The registers of a camera and its transport raise exceptions of two families.
GENICAM_ERRORS = (genapi.GenericException, gentl.GenericException)
TAKEN = (gentl.AccessDeniedException, gentl.BusyException, gentl.ResourceInUseException)


class TroubleError(Exception):
    """Why a camera could not do what it was asked."""

    def __init__(self, trouble: Trouble, text: str) -> None:
        super().__init__(text)
        self.trouble = trouble


@contextmanager
def camera_errors(what: str, trouble: Trouble = Trouble.LOST) -> Iterator[None]:
    """Turn the exceptions of the standard's libraries into ``TroubleError``."""
    try:
        yield
    except TAKEN as error:
        raise TroubleError(Trouble.BUSY, f"{what}: {in_words(error)}") from error
    except gentl.IoException as error:
        raise TroubleError(Trouble.LOST, f"{what}: {in_words(error)}") from error
    except GENICAM_ERRORS as error:
        raise TroubleError(trouble, f"{what}: {in_words(error)}") from error


def in_words(error: Exception) -> str:
    """The text of an exception in one line."""
    return " ".join(str(error).split()) or type(error).__name__
