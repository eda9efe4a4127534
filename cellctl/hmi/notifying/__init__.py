"""Tells other programs what happened at the cell: by an HTTPS request, or by starting a program.

``events`` compares one snapshot of the daemon with the one before, ``outbox`` keeps what is to be
told and tries again, ``senders`` deliver. All of it belongs to the page's process: whatever a
receiver does, the daemon does not notice.
"""
