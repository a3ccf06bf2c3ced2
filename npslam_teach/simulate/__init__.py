"""Worlds, paths and noisy runs through them.

``robot_run`` drives any path through any world. Scenes have modules of their own: ``hand_drawn`` for a world that a
student draws, ``gallery`` for worlds that break the method, ``from_prior`` for worlds from the posterior's prior,
``recording`` for a robot that errs as real ones do.
"""

from npslam_teach.simulate.fifteen_objects import FIFTEEN_CLASSES, designed_path, fifteen_objects, scattered_world
from npslam_teach.simulate.gallery import GALLERY, GalleryWorld, drawn_fifteen
from npslam_teach.simulate.grid_of_rooms import grid_of_rooms
from npslam_teach.simulate.hand_drawn import Drawing, drawn_run
from npslam_teach.simulate.office import OFFICE_CLASSES, office, office_scene
from npslam_teach.simulate.office_camera import rendered_frame, rendered_frame_and_truth
from npslam_teach.simulate.recording import Recording, recording, write_mrclam
from npslam_teach.simulate.robot_run import add_noise, carried, follow, paper_sensor, simulate_run, visible_objects
from npslam_teach.simulate.toy import TOY_CLASSES, toy_objects

__all__ = [
    "FIFTEEN_CLASSES",
    "GALLERY",
    "OFFICE_CLASSES",
    "TOY_CLASSES",
    "Drawing",
    "GalleryWorld",
    "Recording",
    "add_noise",
    "carried",
    "designed_path",
    "drawn_fifteen",
    "drawn_run",
    "fifteen_objects",
    "follow",
    "grid_of_rooms",
    "office",
    "office_scene",
    "paper_sensor",
    "recording",
    "rendered_frame",
    "rendered_frame_and_truth",
    "scattered_world",
    "simulate_run",
    "toy_objects",
    "visible_objects",
    "write_mrclam",
]
