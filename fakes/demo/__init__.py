"""The demonstration: fake cell, daemon and line PLC as separate processes, watched in a terminal."""
