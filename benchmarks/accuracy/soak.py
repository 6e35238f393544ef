"""Random commands over one project: ``python -m benchmarks.accuracy.soak --commands 2000 --children 100``.

Commands, options and values are drawn from the parsers: valid, at an edge, and wrong. Most run in this process, quick
ones only. Children run two at a time; half of them are killed at a random time, and some may write 4 kB at most
(``ulimit -f``, without its signal). ``--full 200`` runs children on a disk with at most 40 kB left (a file system in
memory; needs Linux and root). Checked: exit status 0, 1 or 2 (3 lines of error at most, no traceback,
no internal error), every JSON file parses, every CSV, STEP and PDF file is whole, no hidden file is left by a command
that was not killed, and the memory of this process. Prints each defect with its command; exit status 1 when any.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from dummydesign.cli.completion import _values
from dummydesign.cli.entry import COMMANDS, actions_of, parser_of, run

WRONG = ("", "0", "-1", "nan", "1e400", "1e-300", "x", "🙂", "1,,2", "5:1", "/no/such/file", "--", "3kg", "a" * 300)
PLAIN = (
    "5",
    "10",
    "1,2",
    "5:20:5",
    "0.5",
    "30",
    "15",
    "a.csv",
    "b.csv",
    "campaign",
    "new-1",
    "square:14",
    "150x120",
    "3",
)
NEVER = {"studio", "doctor"}
COSTLY = {"suggest", "loop", "mold", "whatif", "replay", "fit", "on-person", "compare"}
VALID = (
    "predict --young 30 --thickness 10 --depth 1,2,3 --out p.csv",
    "resins show polyurethane-nagoya --out shown",
    "predict --young 30 --thickness 10 --prony 0.1:0.3 --force 5 --velocity 50 --rate 100 --out r.csv",
    "tissues list",
    "resins list --json",
    "history",
    "status",
    "tissues show forefinger --json",
    "completion zsh",
    "campaign new plan --young 30 --pads 5,10",
    "campaign check plan",
    "predict --young 30 --thickness 10 --tissue palm",
)


def draw(rng: random.Random, costly: bool) -> list[str]:
    """A command line: one that works, one made of the parser's options, or one of them with a word changed."""
    if rng.random() < 0.2:
        words = rng.choice(VALID).split()
        if rng.random() < 0.5:
            words[rng.randrange(len(words))] = rng.choice(WRONG)
        return words
    name = rng.choice([one for one in COMMANDS if one not in NEVER and (costly or one not in COSTLY)])
    parser, words, command = parser_of(name), [name], name
    below = actions_of(parser)
    if below and rng.random() < 0.95:
        part = rng.choice(sorted(below))
        parser, words, command = below[part], [name, part], f"{name} {part}"
    for action in parser._actions:
        if not action.option_strings and action.choices is None and rng.random() < 0.9:
            words.append(value(rng, command, action))
        elif action.option_strings and rng.random() < (0.95 if action.required else 0.12):
            words.append(rng.choice(action.option_strings))
            words += [] if action.nargs == 0 else [value(rng, command, action)]
    return words


def value(rng: random.Random, command: str, action: argparse.Action) -> str:
    """A word that an option lists, a plain one, or a wrong one."""
    listed = _values(command, action)
    kind = rng.random()
    return rng.choice(listed) if listed and kind < 0.6 else rng.choice(PLAIN if kind < 0.85 else WRONG)


def judged(words: list[str], status: int, error: str) -> list[str]:
    """What is wrong with the end of a command."""
    bad = []
    if status not in (0, 1, 2):
        bad.append(f"status {status}")
    if "Traceback" in error or "internal error" in error:
        bad.append(error.strip()[-300:])
    if status == 2 and "--json" not in words and sum(line.startswith("error: ") for line in error.splitlines()) != 1:
        bad.append(f"status 2 with {error!r}"[:300])
    return bad


def broken(folder: Path) -> list[str]:
    """Files that are not whole."""
    bad = []
    for path in (path for path in folder.rglob("*") if path.is_file()):
        if any(part.startswith(".") for part in path.relative_to(folder).parts):
            continue
        content = path.read_bytes()
        if path.suffix == ".json":
            with contextlib.suppress(ValueError):
                json.loads(content)
                continue
            bad.append(f"{path.name} does not parse")
        elif (
            (path.suffix == ".pdf" and b"%%EOF" not in content[-20:])
            or (path.suffix == ".step" and b"END-ISO-10303-21;" not in content[-40:])
            or (path.suffix in (".csv", ".toml") and not content.endswith(b"\n"))
        ):
            bad.append(f"{path.name} is cut off")
    return bad


def hidden(folder: Path) -> set[str]:
    """Unfinished files and folders."""
    return {str(path.relative_to(folder)) for path in folder.rglob(".*")}


def in_process(words: list[str]) -> tuple[int, str]:
    """Run a command in this process."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try:
            status = run(words)
        except SystemExit as end:
            status = int(end.code or 0)
        except Exception as problem:
            return 99, f"Traceback: {type(problem).__name__}: {problem}"
    return status, error.getvalue()


def _small_files() -> None:
    """As on a full disk: no file may be longer than 4 KB."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


def children(rng: random.Random, count: int, folder: Path) -> tuple[Counter, list[str]]:
    """Run commands as processes, two at a time; some are killed, some find the disk full."""
    seen: Counter = Counter()
    bad: list[str] = []
    for _ in range(0, count, 2):
        pair = []
        for _ in range(2):
            words = draw(rng, costly=rng.random() < 0.1)
            full = rng.random() < 0.3
            limit = _small_files if full else None
            child = subprocess.Popen(
                [sys.executable, "-m", "dummydesign", *words],
                cwd=folder,
                preexec_fn=limit,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            )
            pair.append((words, child, rng.uniform(0.1, 2.0) if rng.random() < 0.5 else 60.0, full))
        for words, child, most_s, full in pair:
            killed = False
            try:
                error = child.communicate(timeout=most_s)[1]
            except subprocess.TimeoutExpired:
                child.kill()
                killed, error = True, child.communicate()[1]
            seen["killed" if killed else f"full disk {child.returncode}" if full else f"child {child.returncode}"] += 1
            faults = judged(words, 0 if killed else child.returncode, error)
            bad += [f"{' '.join(words)}: {one}" for one in faults]
    return seen, bad


def full_disk(rng: random.Random, count: int, home: Path) -> tuple[Counter, list[str]]:
    """Run commands two at a time over a project on an almost full disk, which a new one replaces after ten commands."""
    seen: Counter = Counter()
    bad: list[str] = []
    disk = home / "disk"
    disk.mkdir()
    for _ in range(0, count, 10):
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(disk)], check=True)
        try:
            folder = disk / "project"
            inside = {f"DUMMYDESIGN_{name.upper()}": str(disk / name) for name in ("home", "cache")}
            environment = {**os.environ, **({**inside, "TMPDIR": str(disk)} if rng.random() < 0.5 else {})}
            words = [sys.executable, "-m", "dummydesign"]
            subprocess.run(
                [*words, "init", str(folder), "--tissue", "forefinger"],
                env=environment,
                check=True,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            (disk / "filler").write_bytes(b"0" * (shutil.disk_usage(disk).free // 4096 - rng.randint(0, 10)) * 4096)
            for _ in range(5):
                pair = [
                    rng.choice(VALID).split() if rng.random() < 0.6 else draw(rng, costly=rng.random() < 0.1)
                    for _ in range(2)
                ]
                running = [
                    subprocess.Popen(
                        [*words, *one],
                        cwd=folder,
                        env=environment,
                        stdout=subprocess.DEVNULL,
                        stderr=subprocess.PIPE,
                        text=True,
                    )
                    for one in pair
                ]
                for one, child in zip(pair, running):
                    error = child.communicate()[1]
                    full = "no space" in error.lower()
                    seen[f"no space {child.returncode}" if full else f"small disk {child.returncode}"] += 1
                    faults = judged(one, child.returncode, error)
                    bad += [f"full disk: {' '.join(one)[:200]}: {fault}" for fault in faults]
                bad += [f"full disk, after {pair}: {fault}" for fault in broken(folder)]
                bad += [f"full disk, after {pair}: left {one}" for one in sorted(hidden(folder))]
        finally:
            subprocess.run(["umount", "-l", str(disk)], check=True)
    return seen, bad


def main() -> int:
    """Run the commands and print what was seen."""
    parser = argparse.ArgumentParser(description="Random commands over one project.")
    parser.add_argument("--commands", type=int, default=2000, help="in this process")
    parser.add_argument("--children", type=int, default=60, help="as processes of their own")
    parser.add_argument("--full", type=int, default=0, help="as processes on a small disk that fills; Linux, root")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=1e9, help="stop the first part after this time")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work) / "project"
        os.environ["DUMMYDESIGN_HOME"] = str(Path(work) / "home")
        os.environ["DUMMYDESIGN_CACHE"] = str(Path(work) / "cache")
        in_process(["init", str(folder), "--tissue", "forefinger"])
        os.chdir(folder)
        trace = "time_s,displacement_mm,force_N\n0,0,0\n0.1,1,2\n0.2,1,1.8\n1,1,1.5\n"
        Path("a.csv").write_text(trace, encoding="utf-8")
        Path("b.csv").write_text("time_s,displacement_mm\n0,0\nx,y\n", encoding="utf-8")
        seen: Counter = Counter()
        bad: list[str] = []
        memory, slow, start = 0, ("", 0.0), time.monotonic()
        for number in range(options.commands):
            words, begun, before = draw(rng, costly=False), time.monotonic(), hidden(folder)
            status, error = in_process(words)
            seen[f"status {status}"] += 1
            slow = max(slow, (" ".join(words)[:80], time.monotonic() - begun), key=lambda one: one[1])
            faults = judged(words, status, error) + [f"left {one}" for one in sorted(hidden(folder) - before)]
            bad += [f"{' '.join(words)[:200]}: {one}" for one in faults]
            if number == options.commands // 4:
                memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            if time.monotonic() - start > options.seconds:
                break
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) / 1024 if memory else float("nan")
        bad += broken(folder)
        more, worse = children(rng, options.children, folder)
        seen.update(more)
        bad += worse + broken(folder)
        if options.full:
            more, worse = full_disk(rng, options.full, Path(work))
            seen.update(more)
            bad += worse
        files = sum(path.is_file() for path in folder.rglob("*"))
    print(f"{sum(seen.values())} commands, {dict(sorted(seen.items()))}")
    print(f"memory grew by {grown:.0f} MB over the last three quarters; {files} files")
    print(f"slowest {slow[1]:.1f} s: {slow[0]}")
    print(f"{len(bad)} defects", *Counter(bad).most_common(40), sep="\n  ")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
