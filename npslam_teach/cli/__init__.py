"""The command line: ``parser`` says how it is asked, ``commands`` what it does, ``reports`` how it answers."""

from npslam_teach.cli.parser import main

__all__ = ["main"]
