"""The command line: `main` runs it and turns every end into an exit code and, at most, one paragraph.

0 a usable result        1 ran, but the data do not support an estimate        2 bad input
70 a fault in Fieldline  130 interrupted; nothing partial is left behind but a flight's files, marked partial
"""

from __future__ import annotations

import os
import sys

from fieldline.errors import FieldlineError, shown

INTERRUPTED = 130
FAULT = 70


def main(arguments: list[str] | None = None) -> int:
    """Run `fieldline` with these arguments (the process's by default) and return the exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    try:
        return _run([one for one in given if one != "--debug"])
    except FieldlineError as error:
        if debug:
            raise
        return _tell(str(error), error.exit_code)
    except KeyboardInterrupt:
        return _tell("interrupted; nothing was written.", INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # whoever read our output has closed it
        return 0
    except MemoryError:
        return _tell("out of memory: split the file, or thin it, and try again.", 2)
    except Exception as error:
        if debug:
            raise
        return _tell(
            f"a fault in Fieldline itself ({type(error).__name__}: {error}). Run the same command with --debug and report what "
            "it prints, together with the input if you can share it, to the project's issue tracker.",
            FAULT,
        )


def _run(arguments: list[str]) -> int:
    """Parse and run; what the parser refuses becomes a sentence too."""
    import typer

    from fieldline.cli.app import app
    from fieldline.cli.outputs import Told

    try:
        code = typer.main.get_command(app).main(args=arguments, prog_name="fieldline", standalone_mode=False)
    except typer.Abort as error:
        raise KeyboardInterrupt from error
    except Exception as error:
        if not hasattr(error, "format_message"):
            raise
        return _refuse_usage(error, arguments)
    if code == INTERRUPTED and not isinstance(code, Told):  # newer Typer ends so by itself, older ones by Abort
        raise KeyboardInterrupt
    return code if isinstance(code, int) else 0


def _refuse_usage(error, arguments: list[str]) -> int:
    """A usage error of the parser: what was wrong, what came, and where the help is."""
    command = getattr(getattr(error, "ctx", None), "command_path", "fieldline")
    message = (error.format_message() or "no command was given.").rstrip(".")
    came = _came(getattr(getattr(error, "param", None), "opts", ()), arguments)
    told = f'; got "{shown(came)}"' if came is not None and f"'{came}'" not in message else ""
    return _tell(f"{message}{told}{'' if message.endswith('?') else '.'} See: {command} --help", 2)


def _came(options, arguments: list[str]) -> str | None:
    """The value that one of these options was last given, where it was."""
    came = None
    for k, one in enumerate(arguments):
        name, joined, value = one.partition("=")
        if name in options:
            came = value if joined else arguments[k + 1] if k + 1 < len(arguments) else None
    return came


def _tell(message: str, code: int) -> int:
    """One paragraph on stderr."""
    print(f"fieldline: {message}", file=sys.stderr)
    return code
