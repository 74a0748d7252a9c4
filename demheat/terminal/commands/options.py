"""The command line: its words, and what is said of a wrong one."""

import argparse
import re

from demheat.io.words import nearest
from demheat.terminal.commands.option_values import Methods, accuracy, seconds

COMMANDS = {
    "init": "write a scene to begin with, in which comments say what else it may have",
    "solve": "solve a scene by one method or some",
    "compare": "all methods that take a scene in one table, with intervals, costs and bounds",
    "effective": "the conductivity tensor to an accuracy, by the method that gets there at least cost",
    "recommend": "what `effective` would do, and what each method would cost; nothing is solved",
    "view": "a picture of a scene, or of its field by a method",
    "report": "one page of HTML: the scene to turn, fields, answers, what was assumed",
    "judge": "what answers of any program to the benchmark's scenes are worth: errors, intervals, costs, a leaderboard",
}

PART = ", as 0.01 or 1%%; default: "
# What other programs call them.
ALSO = {"--budget": "--seconds", "--time": "--seconds", "--timeout": "--seconds", "--limit": "--seconds"}
ALSO |= {"--tolerance": "--accuracy", "--tol": "--accuracy", "--error": "--accuracy", "--output": "--out"}
ALSO |= {"--solver": "--method", "--voxels": "--knob", "--particles": "--knob", "--size": "--knob"}


class Parser(argparse.ArgumentParser):
    """A parser that says what is wrong in one line, with the nearest word that it knows."""

    def __init__(self, *args, **knobs):
        super().__init__(*args, **knobs)
        # By their names, of a program that has such, and of each of them.
        self.commands = {}

    def format_help(self):
        """With what is gathered from all of the package only when it is asked for."""
        from demheat.terminal.commands.helps import told

        return f"{super().format_help()}\n{told(self.prog.partition(' ')[2])}\n"

    def parse_args(self, args=None, namespace=None):
        """Of a command, what it does not know said with its own options."""
        found, others = self.parse_known_args(args, namespace)
        if others:
            own = self.commands[found.command] if self.commands else self
            own.error(f"unrecognized arguments: {' '.join(others)}")
        return found

    def error(self, message):
        """Raise ValueError instead of printing how the command is used."""
        _, unknown, rest = message.partition("unrecognized arguments: ")
        if unknown:
            message += self._meant(rest.split()[0].partition("=")[0])
        _, invalid, rest = message.partition("invalid choice: ")
        if invalid:
            word = rest.split()[0].strip("'\"")
            first = f"; a command comes first, as `demheat solve {word}`" if word.endswith(".toml") else ""
            message += first or nearest(word, COMMANDS)
        # What `option_values` says names the option itself.
        message = re.sub(r"^argument \S+: (?=--)", "", message)
        raise ValueError(f"{message}; {self.prog} --help tells more")

    def _meant(self, word):
        """What may have been meant by an option that is not known here."""
        own = [option for option in self._option_string_actions if option.startswith("--")]
        if ALSO.get(word) in own:
            return f"; did you mean {ALSO[word]!r}?"
        others = [name for name, other in self.commands.items() if word in other._option_string_actions]
        return f"; only {', '.join(others)} has it" if others else nearest(word, own)


def parser(version: str) -> argparse.ArgumentParser:
    """The parser of all commands."""
    top = Parser(
        prog="demheat", description="Heat conduction in a scene that a TOML file describes.", allow_abbrev=False
    )
    top.add_argument("--version", action="version", version=f"demheat {version}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    top.commands = commands.choices
    for name, words in COMMANDS.items():
        command = commands.add_parser(name, help=words, description=words, allow_abbrev=False)
        command.commands = commands.choices
        if name == "judge":
            _of_judge(command)
            continue
        usual = {"nargs": "?", "default": "scene.toml"} if name == "init" else {}
        command.add_argument("scene", metavar="SCENE.toml", **usual)
        _options(command, name)
    return top


def _of_judge(command):
    command.add_argument("files", metavar="ANSWERS.json", nargs="+", help="of one program each, see docs/benchmark.md")
    command.add_argument("--accuracy", type=accuracy, metavar="PART", help=f"to which costs are compared{PART}1e-2")
    command.add_argument("--scenes", metavar="FOLDER", help="default: benchmark/scenes of the clone")
    command.add_argument("--out", metavar="FOLDER", help="for the page; default: demheat-out")


def _options(command, name):
    several = name in ("solve", "compare", "report")
    if several or name in ("view", "effective"):
        command.add_argument(
            *("--method", "--methods"),
            dest="methods",
            action=Methods,
            metavar="NAME",
            help="of a method" + (", again for more, or several with commas" if several else ""),
        )
    if several or name == "view":
        command.add_argument("--knob", action="append", default=[], metavar="NAME=VALUE", help="such as voxels=64")
    if name in ("effective", "recommend"):
        help_ = f"of the answer{PART}the file's, or 1e-3"
        command.add_argument("--accuracy", type=accuracy, metavar="PART", help=help_)
    if several or name == "effective":
        help_ = "that the command may take; what is done by then is told"
        command.add_argument("--seconds", type=seconds, metavar="SECONDS", help=help_)
    if name in ("solve", "compare"):
        command.add_argument("--no-interval", action="store_true", help="spare the runs that tell the error")
    if name == "solve":
        command.add_argument("--write", metavar="FILE", help="the field of one method: .vti, .vtp, .vtu, .xdmf, .npz")
    if name == "compare":
        command.add_argument("--all", action="store_true", help="methods that are seldom compared, too")
        command.add_argument("--force", action="store_true", help="repeat rows that could be reused")
    if name in ("solve", "compare", "view"):
        usual = "none" if name == "solve" else "demheat-out"
        command.add_argument("--out", metavar="FOLDER", help=f"for tables, fields and pictures; default: {usual}")
    if name == "report":
        command.add_argument("--out", metavar="FILE.html", help="the page; default: named as the scene")
