"""Figures of robots and their controllers."""
