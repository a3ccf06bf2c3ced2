"""Every figure file of the course: what it is called, what it shows and how it is drawn.

The numbers are those of the deck that the course replaces. Each module holds the figures of one lesson.
"""

from pathlib import Path

from npslam_teach.course.a_real_robot import figures as a_real_robot_figures
from npslam_teach.course.alternation import figures as alternation_figures
from npslam_teach.course.class_votes import figures as class_votes_figures
from npslam_teach.course.dirichlet_process import figures as dirichlet_process_figures
from npslam_teach.course.draw_your_own_world.film import FILMS
from npslam_teach.course.drift import figures as drift_figures
from npslam_teach.course.fifteen_objects import figures as fifteen_objects_figures
from npslam_teach.course.figure_file import FigureFile, FilmFile, draw_files, draw_films
from npslam_teach.course.filtering import figures as filtering_figures
from npslam_teach.course.office import figures as office_figures
from npslam_teach.course.online import figures as online_figures
from npslam_teach.course.orientation import figures as orientation_figures
from npslam_teach.course.pose_graph import figures as pose_graph_figures
from npslam_teach.course.soft_association import figures as soft_association_figures
from npslam_teach.course.the_posterior import figures as the_posterior_figures
from npslam_teach.course.what_breaks import figures as what_breaks_figures
from npslam_teach.course.why_association import figures
from npslam_teach.system.files import atomic_write

MODULES = (
    figures,
    drift_figures,
    pose_graph_figures,
    dirichlet_process_figures,
    class_votes_figures,
    alternation_figures,
    office_figures,
    filtering_figures,
    the_posterior_figures,
    fifteen_objects_figures,
    what_breaks_figures,
    a_real_robot_figures,
    soft_association_figures,
    orientation_figures,
    online_figures,
)
FIGURES = tuple(sorted((entry for module in MODULES for entry in module.FIGURES), key=lambda entry: entry.name))


def draw_all(folder: Path) -> None:
    """Draw every figure of the course, and an index page with the alternative texts."""
    draw_files(FIGURES, folder)
    draw_films(FILMS, folder)
    with atomic_write(folder / "README.md") as stream:
        stream.write("# Figures\n\n`python3 -m npslam_teach figures` draws them anew, byte for byte.\n")
        for entry in FIGURES:
            stream.write(_section(entry, "png"))
        for entry in FILMS:
            stream.write(_section(entry, "gif"))


def _section(entry: FigureFile | FilmFile, suffix: str) -> str:
    return f"\n## {entry.name}\n\n![{entry.alt}]({entry.name}.{suffix})\n\n{entry.alt}\n"
