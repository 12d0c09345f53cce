"""``python -m artigen``: the command line."""

from artigen.cli import main

if __name__ == "__main__":
    main()
