"""A kernel that is told on standard input how it is reached, so that it can run as another user than its starter.

nbgrader runs a submission in a kernel, and as a rule as the user who grades, who can read the solutions and the
gradebook. A kernel specification with the command

    sh -c "exec sudo -n -u USER python -m npslam_teach.publishing.piped_kernel < {connection_file}"

runs it as a user who can read neither. The shell opens the connection file, which only its owner can, before the user
changes. See "what marks can be trusted with" in ``notebooks/teaching_guide.md``.
"""

import os
import sys
import tempfile
from pathlib import Path


def main() -> None:
    """Run a kernel in an empty folder of the present user's, which is also its home; both go when it ends."""
    from ipykernel.kernelapp import launch_new_instance

    with tempfile.TemporaryDirectory() as folder:
        connection = Path(folder) / "connection.json"
        connection.write_text(sys.stdin.read(), encoding="utf-8")
        os.chdir(folder)
        os.environ |= {"HOME": folder, "IPYTHONDIR": folder, "MPLCONFIGDIR": folder}
        launch_new_instance(["-f", str(connection)])


if __name__ == "__main__":
    main()
