"""``python3 -m npslam_teach COMMAND``: find or make the course's environment, then run the command there."""

import sys

if __name__ == "__main__":
    from npslam_teach._environment import enter_environment

    enter_environment(sys.argv[1:])

    from npslam_teach.cli import main

    sys.exit(main(sys.argv[1:]))
