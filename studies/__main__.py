"""``python -m studies`` lists every study: what it makes, and how long that takes."""

from __future__ import annotations

from studies.registry import STUDIES


def main() -> None:
    """Print one line a study, with the command to type."""
    width = max(len(study.command) for study in STUDIES)
    for study in STUDIES:
        print(f"{study.command:<{width}}  {study.makes}; {study.takes}")


if __name__ == "__main__":
    main()
