"""What is imperfect about devices, each by its size in ``fakes.imperfections``."""
