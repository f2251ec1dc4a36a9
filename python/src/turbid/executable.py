"""Where the program is, and how it is started on several ranks."""

from __future__ import annotations

import os
import shlex
import shutil
from pathlib import Path

from .arguments import whole
from .errors import Failed, Invalid

_LAUNCHER = "mpirun -n {ranks}"
_PLACE = "{ranks}"

PathLike = str | os.PathLike[str]


def find_executable(executable: PathLike | None = None) -> str:
    """The program: what is given, the variable ``TURBID``, ``turbid`` on the ``PATH``, or the build of the repository that holds this package.

    Raises:
        Failed: There is none.
    """
    given = executable or os.environ.get("TURBID")
    if given:
        if found := shutil.which(given):
            return os.path.abspath(found)
        raise Failed(f"{os.fspath(given)} is no program that can be started; give the path of turbid as executable= or in the variable TURBID")
    if found := shutil.which("turbid"):
        return os.path.abspath(found)
    roots = [Path.cwd(), *Path.cwd().parents, *Path(__file__).resolve().parents]
    for root in roots:
        built = root / "target" / "release" / "turbid"
        if (root / "Cargo.toml").is_file() and os.access(built, os.X_OK):
            return str(built)
    raise Failed("turbid is not on the PATH; build it by ./run setup and cargo build --release, and name it in the variable TURBID or as executable=")


def command(words: list[str], ranks: int, executable: PathLike | None, launcher: str | None) -> list[str]:
    """The words that start the program on so many ranks."""
    ranks = whole("ranks", ranks)
    start: list[str] = []
    if ranks > 1 or launcher is not None:
        start = shlex.split(_checked(launcher).replace(_PLACE, str(ranks)))
        if shutil.which(start[0]) is None:
            raise Failed(f"{start[0]}, which starts several ranks, is not installed; install it, give another launcher=, or take ranks=1")
    return [*start, find_executable(executable), *words]


def _checked(launcher: str | None) -> str:
    """A launcher that has a place for the number of ranks."""
    launcher = _LAUNCHER if launcher is None else launcher
    if not isinstance(launcher, str) or _PLACE not in launcher or launcher.split()[0] == _PLACE:
        raise Invalid(f"launcher = {launcher!r}: must be a command with {_PLACE} where the number of ranks goes, as launcher={_LAUNCHER!r}")
    return launcher


def environment(ranks: int) -> dict[str, str]:
    """The variables of this process, with those that Open MPI needs as ``./run`` sets them; what is set stays."""
    variables = {"OMP_NUM_THREADS": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
    if ranks > (os.cpu_count() or 1):
        variables["OMPI_MCA_mpi_yield_when_idle"] = "1"
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        variables |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return variables | dict(os.environ)
