"""Starts the program ``turbid`` and reads, analyses and draws its runs.

    import turbid

    run = turbid.run("examples/shear.toml", set={"time.end": 0.5})
    run.viscosity
    run.plot.viscosity()

All numbers are in the units of the scene. See the README of the package and ``docs/python.md``.
"""

from .animation import Animation
from .box import Box
from .contacts import Bonds, Contacts, Membranes
from .errors import Damaged, Failed, Invalid, Missing, OutOfRange, Refused, TurbidError
from .executable import find_executable
from .fields import Fields
from .frame import Frame
from .frames import Frames
from .launch import Plan, plan, resume, run
from .neighbours import near_pairs
from .pairs import PairDistribution, pair_distribution
from .profiles import Profile, profile
from .progress import Progress
from .results import Run
from .results import open_run as open
from .shear import Shear
from .statistics import Mean, blocking, shortage, standard_error, steady_mean
from .sweeps import open_sweep, sweep
from .viscosity import Viscosity

__version__ = "0.2.0"

__all__ = [
    "Animation",
    "Bonds",
    "Box",
    "Contacts",
    "Damaged",
    "Failed",
    "Fields",
    "Frame",
    "Frames",
    "Invalid",
    "Mean",
    "Membranes",
    "Missing",
    "OutOfRange",
    "PairDistribution",
    "Plan",
    "Profile",
    "Progress",
    "Refused",
    "Run",
    "Shear",
    "TurbidError",
    "Viscosity",
    "blocking",
    "find_executable",
    "near_pairs",
    "open",
    "open_sweep",
    "pair_distribution",
    "plan",
    "profile",
    "resume",
    "run",
    "shortage",
    "standard_error",
    "steady_mean",
    "sweep",
]
