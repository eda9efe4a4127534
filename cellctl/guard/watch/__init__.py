"""What runs inside the guard process: one thread, blocking reads, plain floats.

``main`` starts it and ``loop`` is its one thread. ``loop`` hands samples to ``monitor``, which
decides, requests of the daemon to ``request_handler``, and stops to ``stop_supervisor``.
"""
