"""Decks of 10 to 500 kg, with faces from 1 x 1 m to 5 x 2 m: measured, corrected and mated."""
