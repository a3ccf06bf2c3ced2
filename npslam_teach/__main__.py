"""``python3 -m npslam_teach COMMAND``: find or make the course's environment, then run the command there."""

import os
import sys

from npslam_teach.system import interruption, streams


def run() -> int:
    """Run the command of this process; returns its exit code."""
    streams.open_standard_streams()
    interruption.end_at_once()
    try:
        from npslam_teach.system.interpreter import enter_environment

        with interruption.critical_section():  # a set-up under way explains itself
            enter_environment(sys.argv[1:])

        from npslam_teach.cli.parser import main
        from npslam_teach.system.jupyter import matplotlib_folder

        os.environ["MPLBACKEND"] = "agg"  # nothing is shown, and what a user names may not be installed here
        with matplotlib_folder():
            return main(sys.argv[1:])
    except KeyboardInterrupt:
        interruption.print_interrupted()
        return interruption.EXIT_CODE
    finally:
        interruption.ignore()


if __name__ == "__main__":
    sys.exit(run())
