"""The lessons' own code: one folder for each, named by its subject, with its pictures, checks, figures and explorer.

``explorers`` and ``checking`` are what the lessons share; ``all_figures`` lists every figure file of the course.
``default_style`` is imported first, with any part of the course.
"""

from npslam_teach.course import default_style

__all__ = ["default_style"]
