"""The command line: find the command, read its arguments, call one function, print what it returns; its help."""

from __future__ import annotations

import argparse
import atexit
import errno
import gc
import importlib
import io
import os
import re
import signal
import sys
import tomllib
from collections import Counter
from collections.abc import Sequence
from contextvars import copy_context
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn

from dummydesign._version import __version__
from dummydesign.cli.common_options import add_options, call_in_steps, name_of
from dummydesign.cli.progress import loudness, say, timed
from dummydesign.core.blas_threads import ONE_THREAD
from dummydesign.core.errors import DummydesignError, InputError, NoAnswerError, quantity_name, unknown_name
from dummydesign.core.progress import COMMAND_LINE, STOP

if TYPE_CHECKING:
    from dummydesign.project.folder import Project


@cache
def table_of(name: str) -> dict[str, Any]:
    """Read a table of this folder: ``help`` (choices by option or command and option, examples) or ``gone``."""
    return tomllib.loads((Path(__file__).parent / f"{name}.toml").read_text(encoding="utf-8"))


def meanings_of(command: str, action: argparse.Action) -> dict[str, str]:
    """What the words mean that an option lists in its help; empty for options without such words."""
    name = name_of(action)
    choices = {
        option: words for options, words in table_of("help")["choices"].items() for option in options.split(", ")
    }
    known = choices.get(f"{command.partition(' ')[0]} {name}", choices.get(name, {}))
    if name == "shape":
        from dummydesign.geometry.shape_registry import shape_meanings

        known = shape_meanings() | known
    about = action.help or ""
    return {word: text for word, text in known.items() if re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", about)}


FLAGS = (
    (("--json",), "print one JSON object and nothing else"),
    (("--details",), "print the whole answer instead of one screen"),
    (("-v", "--verbose"), "print each step with the time since the start, and the total and processor time at the end"),
    (("-q", "--quiet"), "no progress, only the answer"),
)


def epilog_of(command: str, parser: argparse.ArgumentParser) -> str:
    """The end of a command's help: what its choices mean, and its examples."""
    rows = []
    for action in parser._actions:
        meanings = meanings_of(command, action)
        if meanings:
            rows.append(f"  {action.option_strings[-1]}")
            rows += [f"    {word:<17} {text}" for word, text in meanings.items()]
    examples = [f"  {what}:\n    dummydesign {words}" for what, words in table_of("help")["examples"].get(command, ())]
    parts = (("what the choices mean:", rows), ("examples:", examples))
    return "\n\n".join("\n".join([title, *lines]) for title, lines in parts if lines)


def finish(parser: argparse.ArgumentParser, command: str) -> None:
    """Add it to a command and, below it, to its actions."""
    for flags, meaning in FLAGS:
        # an action must not take back what stands before it
        parser.add_argument(*flags, action="store_true", default=argparse.SUPPRESS, help=meaning)
    vars(parser)["command"] = command
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, below in action.choices.items():
                below.description = next(one.help for one in action._choices_actions if one.dest == name)
                finish(below, f"{command} {name}")


COMMANDS = (
    "suggest",
    "predict",
    "whatif",
    "import",
    "fit",
    "mold",
    "campaign",
    "loop",
    "replay",
    "compare",
    "on-person",
    "tissues",
    "resins",
    "init",
    "status",
    "history",
    "studio",
    "doctor",
    "completion",
)
"""The commands in the order of the overview; each is a module in ``cli/commands``, but for the one about the command
line itself."""
ELSEWHERE = {"import": "commands.import_", "completion": "completion"}


def module_of(command: str) -> ModuleType:
    """The module of a command; importing it loads nothing heavy.

    It has ``HELP``, ``render``, and ``CALL`` with ``ABOUT_STEPS`` where one call takes the options as they are, else
    ``add_arguments`` and ``run``.
    """
    name = ELSEWHERE.get(command, "commands." + command.replace("-", "_"))
    return importlib.import_module(f"dummydesign.cli.{name}")


def project_here(arguments: Sequence[str]) -> Project | None:
    """The project that a command is run in; None for a command that takes nothing from one, and for its help."""
    if any(word in ("-h", "--help") for word in arguments):
        return None
    from dummydesign.project.folder import GIVEN, OUT, command_of, find_project

    asked = command_of(arguments)
    return find_project() if asked in GIVEN or asked[0] in OUT else None


def with_defaults(project: Project | None, arguments: Sequence[str]) -> list[str]:
    """The command line with what the project adds, right after the command, so that what is typed wins."""
    if project is None:
        return list(arguments)
    from dummydesign.project.folder import command_of, words_for

    position = len(command_of(arguments))
    return [*arguments[:position], *words_for(project, arguments), *arguments[position:]]


def settle_out(project: Project | None, command: str, module: ModuleType, options: argparse.Namespace) -> None:
    """Name the folder of an answer without ``--out``; in a project it lies in the folder for the command."""
    from dummydesign.project.folder import OUT, output_path_for

    if getattr(options, "out", None) == "":
        raise InputError("--out is empty; give a name, or leave it out", "missing", "out", "")
    if command not in OUT or options.out is not None or (project is None and not hasattr(module, "default_out")):
        return
    name = (module.default_out if hasattr(module, "default_out") else module.default_in_project)(options)
    options.out = name if project is None or name is None else output_path_for(project, command, name)


class _Parser(argparse.ArgumentParser):
    """An argument parser whose complaints are one line and exit status 2; its help is made on request."""

    command = ""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given, allow_abbrev=False)
        # a list of numbers may begin with a negative one, so that its own reader refuses it with the allowed range
        vars(self)["_negative_number_matcher"] = re.compile(r"-\.?\d")

    def format_help(self) -> str:
        """Options, what their choices mean, examples."""
        self.epilog = epilog_of(self.command, self)
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        match = re.match(r"argument ([^\s:/]+)", message)
        if missing := re.match(r"the following arguments are required: (.*)", message):
            verb = "are" if ", " in missing[1] else "is"
            message = f"{missing[1]} {verb} required; '{self.prog} --help' explains more"
        raise InputError(message, "bad_arguments", quantity_name(match[1]) if match else "arguments")


def _check_options(parser: argparse.ArgumentParser, name: str, words: list[str]) -> None:
    """Refuse an option that the command has nowhere, before its value is taken for something else."""
    known = _options(parser)
    for word in words:
        option = word.partition("=")[0]
        if option.startswith("--") and " " not in option and option not in ("--", *known):
            import difflib

            near = difflib.get_close_matches(option, known, n=1, cutoff=0.7)
            hint = f"did you mean '{near[0]}'? " if near else ""
            others = [one for one in COMMANDS if one != name and option in _options(parser_of(one))]
            theirs = f"it is an option of {', '.join(others)}; " if others and not near else ""
            message = f"unknown option '{option}': {hint}{theirs}'dummydesign {name} --help' lists them"
            if instead := table_of("gone").get(name, {}).get(option.removeprefix("--")):
                message = f"option '{option}' of {name} is gone: {instead}"
            raise InputError(message, "unknown_option", quantity_name(option), option, sorted(known))


def actions_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Parsers of a command's actions by their names; none of a command without actions."""
    choices = [action.choices for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    return dict(choices[0]) if choices else {}


def _options(parser: argparse.ArgumentParser) -> dict[str, argparse.Action]:
    """Long options of a command and of its actions."""
    options = {name: action for name, action in parser._option_string_actions.items() if name.startswith("--")}
    for below in actions_of(parser).values():
        options |= _options(below)
    return options


def _repeated(parser: argparse.ArgumentParser, words: Sequence[str]) -> list[dict[str, str]]:
    """A warning for each option that is typed more than once and keeps one value."""
    known, typed = _options(parser), Counter(word.partition("=")[0] for word in words)
    return [
        {"code": "option_repeated", "message": f"{option} is given {times} times; the last value counts"}
        for option, times in typed.items()
        if times > 1 and type(known.get(option)) is argparse._StoreAction
    ]


def parser_of(name: str) -> argparse.ArgumentParser:
    """All options of a command."""
    module = module_of(name)
    parser = _Parser(prog=f"dummydesign {name}", description=module.HELP)
    getattr(module, "add_arguments", lambda parser: add_options(parser, module.CALL))(parser)
    finish(parser, name)
    return parser


def _overview() -> str:
    rows = "\n".join(f"  {name:<15} {module_of(name).HELP}" for name in COMMANDS)
    return (
        "usage: dummydesign COMMAND [options]\n\n"
        "Soft dummies of human hand tissue: resin recipe, pad geometry and mould, from measured parameters.\n\n"
        f"commands:\n{rows}\n\n"
        "  dummydesign COMMAND --help   options of one command\n"
        "  dummydesign --version        version\n\n"
        "example: dummydesign suggest --tissue forefinger"
    )


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit status (0 done, 1 no acceptable answer, 2 bad input)."""
    # in a context of its own: how loud it is and what was typed end with the command
    return copy_context().run(_run, arguments)


def _run(arguments: list[str]) -> int:
    loudness.set("")
    COMMAND_LINE.set(tuple(arguments))
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(_overview())
        return 0
    if arguments[0] in ("--version", "-V"):
        print(f"dummydesign {__version__}")
        return 0
    name, as_json = arguments[0], "--json" in arguments
    try:
        if name not in COMMANDS:
            if isinstance(instead := table_of("gone").get(name), str):
                raise InputError(f"command '{name}' is gone: {instead}", "unknown_name", "command", name)
            raise unknown_name("command", name, COMMANDS)
        module = module_of(name)
        project = project_here(arguments)
        words = with_defaults(project, arguments)
        parser = parser_of(name)
        _check_options(parser, name, words[1:])
        options = parser.parse_args(words[1:])
        loudness.set(_loudness(options))
        added = [word for word in words if word not in arguments]
        if added and project is not None:
            say(f"from project '{project.name}': {' '.join(added)}")
        COMMAND_LINE.set(tuple(words))
        repeated = _repeated(parser, arguments[1:])
        problem: NoAnswerError | None = None
        try:
            settle_out(project, name, module, options)
            with timed():
                result = getattr(module, "run", lambda options: _called(module, options))(options)
            verdict = result.get("verdict")
            if isinstance(verdict, dict) and verdict.get("light") == "red":
                message = "the verdict on the pad is red: do not use it"
                problem = NoAnswerError("not_representative", message, quantity="verdict")
        except NoAnswerError as reason:
            result, problem = reason.result, reason
        except ModuleNotFoundError as reason:
            module_name = (reason.name or "dummydesign").split(".")[0]
            if module_name == "dummydesign":
                raise
            package = PACKAGES.get(module_name, module_name)
            message = f"the package '{package}' is needed for this and not installed: pip install {package}"
            raise InputError(message, "program_missing", "package", package) from None
        except OSError as reason:
            if reason.errno in FULL:
                from dummydesign.core.files import unwritable

                raise unwritable("file", reason.filename or "?", reason, "file") from None
            if reason.errno != errno.ENAMETOOLONG:
                raise
            message = f"the name of a file or folder is too long: '{str(reason.filename)[:40]}...'; give a shorter one"
            raise InputError(message, "malformed", "path", reason.filename) from None
        if as_json:
            from dummydesign.core.serialise import json_text

            if repeated:
                result = {**result, "warnings": [*result.get("warnings", []), *repeated]}
            print(json_text(name, {**result, **({} if problem is None else {"error": problem.to_dict()})}))
        elif result:
            print(_render_of(module, options)(result))
        for one in repeated if not as_json else ():
            # Beside the answer: not every screen has room for its warnings.
            print(f"warning: {one['message']}", file=sys.stderr)
        if problem is not None:
            print(f"error: {problem}", file=sys.stderr)
        return 0 if problem is None else 1
    except DummydesignError as problem:
        if as_json:
            import json

            print(json.dumps({"error": problem.to_dict()}, indent=2))
        print("error: " + " ".join(str(problem).split()), file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("error: stopped by the user", file=sys.stderr)
        return STOPPED
    except BrokenPipeError:
        raise
    except Exception as problem:
        if os.environ.get("DUMMYDESIGN_DEBUG"):
            raise
        if isinstance(problem, OSError) and problem.errno in FULL:
            print(f"error: the answer cannot be printed: {problem.strerror}", file=sys.stderr)
            return 2
        text = " ".join(str(problem).split())
        print(
            f"error: internal error ({type(problem).__name__}: {text}); "
            "please report it with the command; DUMMYDESIGN_DEBUG=1 shows where",
            file=sys.stderr,
        )
        return 1


def screen_of(command: str, result: dict[str, Any]) -> str:
    """The one screen of an answer, as the command prints it."""
    return str(module_of(command).render(result))


def _render_of(module: Any, options: argparse.Namespace) -> Any:
    """What lays the answer out: one screen, or all of it with --details."""
    return getattr(module, "render_details" if getattr(options, "details", False) else "render", module.render)


def _called(module: Any, options: argparse.Namespace) -> dict[str, Any]:
    """The answer of a command that is one call."""
    answer: dict[str, Any] = call_in_steps(module.ABOUT_STEPS, module.CALL, options).to_dict()
    return answer


def _loudness(options: argparse.Namespace) -> str:
    """How much to print of the work: by -v ``verbose``, by -q ``quiet``."""
    verbose, quiet = getattr(options, "verbose", False), getattr(options, "quiet", False)
    if verbose and quiet:
        raise InputError("--verbose and --quiet: the one or the other", "conflict", "verbose")
    return "verbose" if verbose else "quiet" if quiet else ""


PACKAGES = {
    "skfem": "scikit-fem",
    "OCP": "cadquery",
    "vtkmodules": "vtk",
    "PIL": "pillow",
    "fastapi": "nicegui",
    "starlette": "nicegui",
    "uvicorn": "nicegui",
}
"""Packages by the name of their module, where the two differ."""
FULL = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG", "EROFS") if hasattr(errno, name)}
"""Reasons of the system why no file can be written: a full disk, a quota, a limit of size, a disk for reading only."""
GARBAGE = 100_000
"""Objects more than were given up at which cycles are looked for."""
STOPPED = 130
"""Exit status of a command that the user ended."""


def _stop(*_: object) -> NoReturn:
    """End as by Ctrl-C, so that half-written folders are cleared away."""
    STOP.set()
    raise KeyboardInterrupt


def main() -> NoReturn:
    """Entry point without arguments; reads ``sys.argv`` and exits with the command's status."""
    # before numpy is loaded, for this process and those it starts
    os.environ.update(ONE_THREAD)
    # searches for cycles among what the imports made cost a twentieth of a command's time
    gc.set_threshold(GARBAGE)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the caller
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # names may have letters that the terminal's code page lacks
            stream.reconfigure(errors="backslashreplace")
    for name in ("SIGTERM", "SIGHUP", "SIGINT"):
        if hasattr(signal, name) and signal.getsignal(getattr(signal, name)) != signal.SIG_IGN:
            signal.signal(getattr(signal, name), _stop)
    try:
        status = run(sys.argv[1:])
        sys.stdout.flush()
    except OSError as problem:
        # what is still buffered must not raise at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 0  # the reader (such as head) has seen enough
        if not isinstance(problem, BrokenPipeError):
            print(f"error: the answer cannot be printed: {problem.strerror}", file=sys.stderr)
            status = 2
    if status == STOPPED:
        # Where the interrupt came inside exec() of a text, as dataclasses do, Python would end by the signal instead.
        atexit._run_exitfuncs()
        sys.stderr.flush()
        os._exit(STOPPED)
    sys.exit(status)
