"""``python -m dummydesign.studies.verification.check`` runs every check and writes VERIFICATION.md.

Each check states what is expected and from where, what was found, and the tolerance. The exit code is 1 when one
fails. ``--fast`` runs the quick ones only and writes nothing.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Check:
    """One verified number; ``tolerance`` is relative unless ``absolute``, ``one_sided`` asks for at least expected."""

    group: str
    name: str
    expected: float
    found: float
    tolerance: float
    source: str
    absolute: bool = False
    one_sided: bool = False

    @property
    def deviation(self) -> float:
        """Difference to what is expected, relative unless absolute."""
        difference = self.found - self.expected
        return difference if self.absolute else difference / self.expected

    @property
    def passed(self) -> bool:
        """Whether the deviation is within the tolerance."""
        if self.one_sided:
            return self.deviation >= -self.tolerance
        return abs(self.deviation) <= self.tolerance


def run(fast: bool, say: Callable[[str], None] | None = None) -> list[Check]:
    """Run the checks; ``fast`` leaves out those that take more than about a second."""
    from dummydesign.studies.verification import slabs_and_pucks as verification_checks

    found: list[Check] = []
    for is_fast, make in verification_checks.ALL:
        if fast and not is_fast:
            continue
        began = time.perf_counter()
        rows: Iterable[Check] = make()
        found += list(rows)
        if say:
            say(f"{make.__name__}: {time.perf_counter() - began:.1f} s")
    return found


def document(checks: list[Check]) -> str:
    """The text of VERIFICATION.md."""
    failed = sum(not check.passed for check in checks)
    lines = [
        "# Verification of the pad model",
        "",
        "Made by `python -m dummydesign.studies.verification.check`; do not edit. Lengths in thicknesses,",
        "stresses in shear moduli unless a unit is given. Tolerances are relative unless marked `abs`; `>=` asks",
        "for at least what is expected. The comparison with FElupe, a separate program, is",
        "`python benchmarks/pad_felupe.py`;",
        "its figures are in `docs/pad.md`.",
        "",
        f"{len(checks)} checks, {failed} failed.",
    ]
    for group in dict.fromkeys(check.group for check in checks):
        lines += ["", f"## {group}", "", "| check | expected | found | deviation | tolerance | source | |"]
        lines.append("|---|---|---|---|---|---|---|")
        for check in checks:
            if check.group == group:
                lines.append(_row(check))
    return "\n".join(lines) + "\n"


def _row(check: Check) -> str:
    percent = f"{check.deviation:+.2g}" if check.absolute else f"{100 * check.deviation:+.3f} %"
    tolerance = f"{check.tolerance:g} abs" if check.absolute else f"{100 * check.tolerance:g} %"
    sign = ">= " if check.one_sided else ""
    verdict = "pass" if check.passed else "FAIL"
    return (
        f"| {check.name} | {sign}{check.expected:.5g} | {check.found:.5g} | {percent} | {tolerance} | "
        f"{check.source} | {verdict} |"
    )


def main() -> None:
    """Run the checks and write the document beside the package."""
    from dummydesign.core.files import write_text

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fast", action="store_true", help="only the quick checks; write nothing")
    parser.add_argument("--out", default=None, metavar="FILE", help="where to write (default VERIFICATION.md)")
    options = parser.parse_args()
    os.environ["DUMMYDESIGN_CACHE"] = "off"  # what is verified is solved
    checks = run(options.fast, print)
    text = document(checks)
    if options.fast:
        print(text)
    else:
        target = Path(options.out) if options.out else Path(__file__).parents[3] / "VERIFICATION.md"
        write_text(target, text)
    failed = [check for check in checks if not check.passed]
    for check in failed:
        print(f"failed: {check.group}: {check.name}: expected {check.expected:.6g}, found {check.found:.6g}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
