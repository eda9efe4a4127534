"""The protocols of the devices, each written from its document alone, and a line PLC.

A server gets the world through callables, so each of them runs without a cell too.
"""
