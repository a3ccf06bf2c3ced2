"""Make the course's pictures look as its texts describe, whatever a user's ``matplotlibrc`` says.

Its fonts, sizes, colours and its use of LaTeX, which may not be installed, are set back when any part of the course is
imported.
"""

from npslam_teach.plotting.style import put_settings_aside

put_settings_aside()
