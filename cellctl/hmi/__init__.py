"""The operator page and the HTTP API, in a process of their own.

``daemon_link`` follows the daemon over its socket and brings it commands. ``hub`` keeps the newest
snapshot, which ``event_stream`` sends on to every browser as it came. ``visitors`` says who asks,
what they may ask and how often. ``routes`` is the API, ``page/`` the page. Nothing here decides
what the cell does: the daemon checks every command again.
"""
