"""Entry of the process of the maker's library. The daemon imports this and no more of it."""

from multiprocessing.connection import Connection

from drivers.camera.gige.protocol import RequestFailed, Trouble


def serve(connection: Connection, parent: int) -> None:
    """Answer requests until the other end closes; ``parent`` is the process there."""
    try:
        # Imported here: harvesters loads the standard's libraries, which belong into this process
        # and not into the daemon.
        from drivers.camera.gige.library_process import child
    except ImportError as error:
        connection.recv()
        connection.send(
            RequestFailed(
                Trouble.PRODUCER, f"harvesters is not installed: {error}; pip install harvesters"
            )
        )
        return
    child.serve(connection, parent)
