"""The command line: reads arguments, calls one function, prints what it returns. Nothing is computed here."""

from __future__ import annotations

import argparse
import difflib
import io
import os
import signal
import sys
from typing import Any, NoReturn

from dummydesign._version import __version__
from dummydesign.cli.every_command import epilog_of, finish
from dummydesign.cli.in_project import project_here, settle_out, with_defaults
from dummydesign.cli.registry import COMMANDS, module_of
from dummydesign.cli.steps import loudness, say, timed
from dummydesign.core.errors import DummydesignError, InputError, NoAnswerError, unknown_name
from dummydesign.core.outputs.manifest import COMMAND_LINE
from dummydesign.core.outputs.plain import json_text
from dummydesign.core.outputs.progress import STOP
from dummydesign.core.threads import ONE_THREAD


class _Parser(argparse.ArgumentParser):
    """An argument parser whose complaints are one line and exit status 2; its help is made when asked for."""

    command = ""

    def format_help(self) -> str:
        """Options, what their choices mean, examples."""
        self.epilog = epilog_of(self.command, self)
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        raise InputError(message)


def _check_options(parser: argparse.ArgumentParser, name: str, words: list[str]) -> None:
    """Refuse an option that the command has nowhere, before its value is taken for something else."""
    known = _options(parser)
    for word in words:
        option = word.partition("=")[0]
        if option.startswith("--") and " " not in option and option not in known | {"--"}:
            near = difflib.get_close_matches(option, known, n=1, cutoff=0.7)
            hint = f"did you mean '{near[0]}'? " if near else ""
            others = [one for one in COMMANDS if one != name and option in _options(parser_of(one))]
            theirs = f"it is an option of {', '.join(others)}; " if others and not near else ""
            raise InputError(f"unknown option '{option}': {hint}{theirs}'dummydesign {name} --help' lists them")


def _options(parser: argparse.ArgumentParser) -> set[str]:
    """Long options of a command and of its actions."""
    found = set(parser._option_string_actions)
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            found.update(*(_options(one) for one in action.choices.values()))
    return {one for one in found if one.startswith("--")}


def parser_of(name: str) -> argparse.ArgumentParser:
    """All options of a command."""
    module = module_of(name)
    parser = _Parser(prog=f"dummydesign {name}", description=module.HELP, allow_abbrev=False)
    module.add_arguments(parser)
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


def _print_result(command: str, result: dict[str, Any], as_json: bool, render: Any) -> None:
    if as_json:
        print(json_text(command, result))
    else:
        print(render(result))


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit status (0 done, 1 no acceptable answer, 2 bad input)."""
    kept, line = loudness.set(""), COMMAND_LINE.set(tuple(arguments))
    try:
        return _run(arguments)
    finally:
        COMMAND_LINE.reset(line)
        loudness.reset(kept)


def _run(arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(_overview())
        return 0
    if arguments[0] in ("--version", "-V"):
        print(f"dummydesign {__version__}")
        return 0
    name, as_json = arguments[0], "--json" in arguments
    try:
        if name not in COMMANDS:
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
        settle_out(project, name, module, options)
        COMMAND_LINE.set(tuple(words))
        try:
            with timed():
                result = module.run(options)
        except NoAnswerError as reason:
            if as_json:
                problem = {"code": reason.code, "message": str(reason)}
                _print_result(name, {**reason.result, "error": problem}, True, None)
            elif reason.result:
                print(_render_of(module, options)(reason.result))
            print(f"error: {reason}", file=sys.stderr)
            return 1
        red = _red(result)
        _print_result(name, {**result, **red}, as_json, _render_of(module, options))
        if red:
            print(f"error: {red['error']['message']}", file=sys.stderr)
        return 1 if red else 0
    except DummydesignError as problem:
        print("error: " + " ".join(str(problem).split()), file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("error: stopped by the user", file=sys.stderr)
        return 130
    except BrokenPipeError:
        raise
    except Exception as problem:
        if os.environ.get("DUMMYDESIGN_DEBUG"):
            raise
        text = " ".join(str(problem).split())
        print(
            f"error: internal error ({type(problem).__name__}: {text}); "
            "please report it with the command; DUMMYDESIGN_DEBUG=1 shows where",
            file=sys.stderr,
        )
        return 1


def _red(result: dict[str, Any]) -> dict[str, Any]:
    """The error of an answer whose verdict is red; nothing of any other."""
    verdict = result.get("verdict")
    if not isinstance(verdict, dict) or verdict.get("light") != "red":
        return {}
    return {"error": {"code": "not_representative", "message": "the pad is not representative of the tissue"}}


def _render_of(module: Any, options: argparse.Namespace) -> Any:
    """What lays the answer out: one screen, or all of it with --details."""
    if getattr(options, "details", False):
        return getattr(module, "render_details", module.render)
    return module.render


def _loudness(options: argparse.Namespace) -> str:
    """How much is told of the work: by -v ``verbose``, by -q ``quiet``."""
    verbose, quiet = getattr(options, "verbose", False), getattr(options, "quiet", False)
    if verbose and quiet:
        raise InputError("--verbose and --quiet: the one or the other")
    return "verbose" if verbose else "quiet" if quiet else ""


def _stop(*_: object) -> NoReturn:
    """End as by Ctrl-C, so that half-written folders are cleared away."""
    STOP.set()
    raise KeyboardInterrupt


def main() -> NoReturn:
    """Entry point without arguments; reads ``sys.argv`` and exits with the command's status."""
    # before numpy is loaded, for this process and those it starts
    os.environ.update(ONE_THREAD)
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
    except BrokenPipeError:
        # The reader (such as head) has seen enough; what is still buffered must not raise at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 0
    sys.exit(status)
