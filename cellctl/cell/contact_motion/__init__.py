"""Motions in contact that are streamed: touches, slides, presses and fed insertions.

A search or an insertion is written in these words; which controller follows the stream, and at
which rate, it does not know.
"""
