"""A child that ends at once: what it wrote is kept, nothing is taken apart."""

from __future__ import annotations

import subprocess
import sys


def test_what_was_printed_is_kept_and_the_status_is_0():
    code = "import atexit; from dummydesign.core.progress import leave; atexit.register(print, 'taken apart');"
    done = subprocess.run([sys.executable, "-c", code + "print('done'); leave()"], capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()) == (0, ["done"])
