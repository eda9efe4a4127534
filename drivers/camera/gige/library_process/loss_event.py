"""The event by which a producer says that something has become of its camera."""

from typing import Any

from genicam import gentl

from drivers.camera.gige.library_process.delivered import said

_OF_THE_MODULE = gentl.EVENT_TYPE_LIST.EVENT_MODULE


class LossEvent:
    """The events of a device module itself (GenTL 1.5, 4.2), of which the loss is one.

    Each maker numbers them as he likes, and many have none. So an event is a reason to ask the
    camera at once, and no answer by itself.
    """

    def __init__(self, device: Any) -> None:
        """``device`` is the open module of genicam."""
        self._event: Any = said(
            lambda: gentl.EventManagerModule(device.register_event(_OF_THE_MODULE)), None
        )

    def told(self) -> bool:
        """Whether there was one since the last call."""
        if not said(lambda: int(self._event.num_in_queue), 0):
            return False
        said(lambda: self._event.flush_event_queue(), None)  # noqa: PLW0108 - it may have none
        return True

    def close(self) -> None:
        """Before the device is closed: a producer may tell of it into what is gone."""
        said(lambda: self._event.unregister_event(), None)  # noqa: PLW0108 - it may have none
        self._event = None
