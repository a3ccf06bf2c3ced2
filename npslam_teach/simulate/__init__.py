"""Worlds, paths and noisy runs through them. The only place where noise is drawn.

``runs`` drives any path through any world; the other modules each hold a scene.
"""

from npslam_teach.simulate.fifteen import FIFTEEN_CLASSES, designed_path, fifteen_objects, scattered_world
from npslam_teach.simulate.office import OFFICE_CLASSES, office, office_scene
from npslam_teach.simulate.office_camera import rendered_frame, rendered_frame_and_truth
from npslam_teach.simulate.runs import add_noise, follow, paper_sensor, simulate_run, visible_objects
from npslam_teach.simulate.toy import TOY_CLASSES, toy_objects

__all__ = [
    "FIFTEEN_CLASSES",
    "OFFICE_CLASSES",
    "TOY_CLASSES",
    "add_noise",
    "designed_path",
    "fifteen_objects",
    "follow",
    "office",
    "office_scene",
    "paper_sensor",
    "rendered_frame",
    "rendered_frame_and_truth",
    "scattered_world",
    "simulate_run",
    "toy_objects",
    "visible_objects",
]
