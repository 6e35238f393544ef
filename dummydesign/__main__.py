"""Run the command line with ``python -m dummydesign``."""

from dummydesign.cli import main

if __name__ == "__main__":
    main()
