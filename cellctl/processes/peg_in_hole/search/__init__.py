"""Strategies that find a hole by touch, written in the words of ``ContactMotions``."""
