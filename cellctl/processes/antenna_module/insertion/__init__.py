"""Judging how a plug goes into its socket, by depth and wrench.

- ``curve``: samples, and the file with them
- ``limits``: phases and what each allows
- ``watch``: sample by sample, for a live insertion
- ``features``, ``verdict``: of a whole curve

Depth is 0 where tips and face first touch and grows into the socket. Wrenches are what the socket
does to the plug, in the axes of the plug at the connector: z against the insertion, so that a
resistance is positive.
"""
