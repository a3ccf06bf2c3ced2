"""Files in and out: robot logs (``log_files``), pose graphs (``g2o``), the authors' data (``mu2016``, ``download``)."""

from npslam_teach.datasets.download import fetch_mu2016_simulation, fetch_stata_office
from npslam_teach.datasets.g2o import load_g2o, save_g2o
from npslam_teach.datasets.log_files import load_log, save_log
from npslam_teach.datasets.mu2016 import load_mu2016_simulation, load_stata_office

__all__ = [
    "fetch_mu2016_simulation",
    "fetch_stata_office",
    "load_g2o",
    "load_log",
    "load_mu2016_simulation",
    "load_stata_office",
    "save_g2o",
    "save_log",
]
