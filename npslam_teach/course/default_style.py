"""The course's pictures are those that its texts describe, whatever a user's ``matplotlibrc`` asks for.

LaTeX that may not be there, other fonts, sizes and colours are put aside as soon as a lesson imports anything of ours.
"""

from npslam_teach.plotting.style import put_settings_aside

put_settings_aside()
