"""Run the command line with ``python -m dummydesign``."""

from dummydesign.cli.entry import main

if __name__ == "__main__":
    main()
