"""What the options of the command line are made of: each fails with one sentence that says what was expected."""

import argparse


class Parser(argparse.ArgumentParser):
    """A parser that says what is wrong in one line; ``--help`` has the rest."""

    more_help = None  # a function that writes what stands below the options; called only when help is printed

    def format_help(self) -> str:
        """The usual help, and below it what is more."""
        below = "" if self.more_help is None else f"\n{self.more_help()}\n"
        return super().format_help() + below

    def error(self, message: str):
        """End with one sentence."""
        self.exit(2, f"{self.prog}: {message}\n")


def method(text: str) -> str:
    """The name of a method; names are read only when one is given, for other commands need no NumPy."""
    if text not in method_names():
        raise argparse.ArgumentTypeError(f"expected one of {', '.join(method_names())}, got {text!r}")
    return text


def method_names() -> list[str]:
    """All names in the registry."""
    from npslam_teach.methods import METHODS

    return list(METHODS)


def number(text: str) -> float:
    """Any number; its range is the business of whoever uses it. Fails with one sentence."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected a number, got {text!r}") from None


def index(text: str) -> int:
    """A whole number from 0."""
    return _integer(text, 0)


def count(text: str) -> int:
    """A whole number from 1."""
    return _integer(text, 1)


def port(text: str) -> int:
    """The number of a TCP port."""
    return _integer(text, 1, 65_535)


def _integer(text: str, least: int, most: int = 1_000_000) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 20 and least <= int(text) <= most):
        raise argparse.ArgumentTypeError(f"expected a whole number from {least} to {most}, got {text!r}")
    return int(text)


def numbers(how_many: int):
    """A parser of so many numbers with commas between them."""

    def parse(text: str) -> tuple[float, ...]:
        parts = text.split(",")
        if len(parts) != how_many:
            raise argparse.ArgumentTypeError(f"expected {how_many} numbers with commas between them, got {text!r}")
        return tuple(number(part) for part in parts)

    return parse


def methods(text: str) -> list[str]:
    """Names of methods with commas between them, each once."""
    names, known = text.split(","), method_names()
    for name in names:
        if name not in known:
            raise argparse.ArgumentTypeError(f"expected some of {', '.join(known)}, got {name!r}")
    if len(set(names)) < len(names):
        raise argparse.ArgumentTypeError(f"expected each method once, got {text!r}")
    return names
