"""Tests solve what they test: the user's cache is neither read nor written, also by commands they start."""

import os

os.environ["DUMMYDESIGN_CACHE"] = "off"
