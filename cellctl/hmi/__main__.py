"""`python -m cellctl.hmi`."""

from cellctl.hmi.main import main

if __name__ == "__main__":
    main()
