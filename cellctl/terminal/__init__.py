"""Text as commands print it, whoever brings the command: the core, a process or a driver."""
