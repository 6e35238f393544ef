"""``python -m studies.verification`` runs every check and writes VERIFICATION.md.

Each check states what is expected and from where, what was found, and the tolerance. The exit code is 1 when one
fails. ``--fast`` runs the quick ones only and writes nothing.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from dummydesign.core.files import write_text
from studies.verification.document import document, run


def main() -> None:
    """Run the checks and write the document beside the package."""
    name = "python -m studies.verification"
    parser = argparse.ArgumentParser(prog=name, description=__doc__.splitlines()[0])
    parser.add_argument("--fast", action="store_true", help="only the quick checks; write nothing")
    parser.add_argument("--out", default=None, metavar="FILE", help="where to write (default VERIFICATION.md)")
    options = parser.parse_args()
    os.environ["DUMMYDESIGN_CACHE"] = "off"  # what is verified is solved
    checks = run(options.fast, print)
    text = document(checks)
    if options.fast:
        print(text)
    else:
        target = Path(options.out) if options.out else Path(__file__).parents[2] / "VERIFICATION.md"
        write_text(target, text)
    failed = [check for check in checks if not check.passed]
    for check in failed:
        print(f"failed: {check.group}: {check.name}: expected {check.expected:.6g}, found {check.computed:.6g}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
