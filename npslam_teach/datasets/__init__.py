"""Files in and out.

Robot logs (``log_files``; what they hold ``log_fields``, and how: ``npz_files``, ``csv_files``), pose graphs (``g2o``),
results for other programs (``result_files``), recordings of real robots (``recordings``, ``ros_bags``), the authors'
data (``mu2016``, ``download``).
"""

from npslam_teach.datasets.download import fetch_mu2016_simulation, fetch_stata_office
from npslam_teach.datasets.g2o import load_g2o, save_g2o
from npslam_teach.datasets.log_files import load_log, save_log
from npslam_teach.datasets.mu2016 import load_mu2016_simulation, load_stata_office
from npslam_teach.datasets.recordings import load_hidden, load_mrclam
from npslam_teach.datasets.result_files import save_objects, save_tum
from npslam_teach.datasets.ros_bags import load_rosbag

__all__ = [
    "fetch_mu2016_simulation",
    "fetch_stata_office",
    "load_g2o",
    "load_hidden",
    "load_log",
    "load_mrclam",
    "load_mu2016_simulation",
    "load_rosbag",
    "load_stata_office",
    "save_g2o",
    "save_log",
    "save_objects",
    "save_tum",
]
