"""How far a run has come, from its output folder, shown on a terminal, in a notebook or in a log."""

from __future__ import annotations

import html
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from .files import last_row


@dataclass(frozen=True)
class Progress:
    """How far a run in time has come.

    Attributes:
        time: Time that it has reached.
        end: Time at which it ends.
        step: Steps so far.
        viscosity: Relative viscosity at that time, where there is one.
        seconds: Wall time since the start.
        seconds_left: Estimate of the wall time that is left; ``None`` at the very start.
    """

    time: float
    end: float
    step: int
    viscosity: float | None
    seconds: float
    seconds_left: float | None

    @property
    def fraction(self) -> float:
        """Part of the time that is done, from 0 to 1."""
        return min(max(self.time / self.end, 0.0), 1.0) if self.end > 0 else 0.0

    def __str__(self) -> str:
        text = f"time {self.time:.4g} of {self.end:g}, step {self.step}"
        if self.viscosity is not None:
            text += f", viscosity {self.viscosity:.4f}"
        if self.seconds_left is not None:
            text += f", {self.seconds_left:.0f} s left"
        return text


class Watcher:
    """Reads the series of a run under way."""

    def __init__(self, folder: Path, end: float) -> None:
        self.series = folder / "series.csv"
        self.end = end
        self.start = time.monotonic()
        self.first: float | None = None
        # what an earlier run has left says nothing
        self.before = self._stamp()

    def look(self) -> Progress | None:
        """How far it has come; nothing before the first step."""
        stamp = self._stamp()
        row = last_row(self.series) if stamp and stamp != self.before else None
        if row is None or "time" not in row:
            return None
        at, seconds = row["time"], time.monotonic() - self.start
        self.first = at if self.first is None else self.first
        done = (at - self.first) / (self.end - self.first) if self.end > self.first else 0.0
        left = seconds * (1.0 - done) / done if done > 0.01 else None
        return Progress(at, self.end, int(row.get("step", 0)), row.get("viscosity"), seconds, left)

    def _stamp(self) -> tuple[int, int] | None:
        try:
            found = self.series.stat()
        except OSError:
            return None
        return found.st_mtime_ns, found.st_size


class Display(Protocol):
    """Shows progress."""

    def show(self, progress: Progress) -> None:
        """Shows how far the run has come."""

    def end(self) -> None:
        """The run has ended."""


class Silent:
    """Shows nothing."""

    def show(self, progress: Progress) -> None:
        """Nothing."""

    def end(self) -> None:
        """Nothing."""


class Called:
    """Calls a function."""

    def __init__(self, function: Callable[[Progress], object]) -> None:
        self.function = function

    def show(self, progress: Progress) -> None:
        """Calls the function."""
        self.function(progress)

    def end(self) -> None:
        """Nothing."""


class Line:
    """One line of a terminal that is written over."""

    def __init__(self) -> None:
        self.width = 0

    def show(self, progress: Progress) -> None:
        """Writes the line anew."""
        bar = "█" * round(30 * progress.fraction)
        text = f"{bar:░<30} {progress}"
        print("\r" + text.ljust(self.width), end="", file=sys.stderr, flush=True)
        self.width = len(text)

    def end(self) -> None:
        """Removes the line."""
        if self.width:
            print("\r" + " " * self.width + "\r", end="", file=sys.stderr, flush=True)


class Log:
    """A line for each tenth of the run."""

    def __init__(self) -> None:
        self.tenths = 0

    def show(self, progress: Progress) -> None:
        """Prints a line once another tenth is done."""
        tenths = int(10 * progress.fraction)
        if self.tenths < tenths < 10:
            self.tenths = tenths
            print(progress, file=sys.stderr, flush=True)

    def end(self) -> None:
        """Nothing."""


class Notebook:
    """A bar below the cell of a notebook."""

    def __init__(self) -> None:
        self.handle: Any = None

    def show(self, progress: Progress) -> None:
        """Shows the bar, or moves it."""
        from IPython.display import HTML, display

        bar = f"<progress max='1' value='{progress.fraction:.4f}' style='width: 20em'></progress> {html.escape(str(progress))}"
        if self.handle is None:
            self.handle = display(HTML(bar), display_id=True)
        else:
            self.handle.update(HTML(bar))

    def end(self) -> None:
        """Removes the bar."""
        if self.handle is not None:
            from IPython.display import HTML

            self.handle.update(HTML(""))


def display_of(progress: bool | Callable[[Progress], object]) -> Display:
    """What shows progress here."""
    if callable(progress):
        return Called(progress)
    if not progress:
        return Silent()
    if in_notebook():
        return Notebook()
    return Line() if sys.stderr.isatty() else Log()


def in_notebook() -> bool:
    """Whether a kernel of a notebook runs this."""
    if "IPython" not in sys.modules:
        return False
    from IPython import get_ipython

    shell = get_ipython()
    return hasattr(shell, "kernel")
