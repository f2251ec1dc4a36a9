"""The program under way: what it prints while it runs, and what its end means."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO

from .errors import Failed, Refused
from .progress import Progress, Watcher, display_of

ShownProgress = bool | Callable[[Progress], object]

_REFUSED = 2
# what the program says of a folder whose run is the same and complete
_FINISHED = "holds this run, finished"
_PAUSE = 0.25
# a note that is an error is followed by the end of the program within this time, and is told by an exception
_HELD_BACK = 3.0


class Program:
    """The program, started by some words.

    Args:
        words: The command.
        variables: Its environment.
        written: The file that was written for a scene that was given as a ``dict``, which no refusal needs to name.
        folder: The output folder of a run.
        whole_group: Whether what the program has started is to end with it.
    """

    def __init__(
        self, words: list[str], variables: dict[str, str], written: Path | None, folder: Path | None = None, whole_group: bool = False
    ) -> None:
        self.words = words
        self.written = written
        self.folder = folder
        self.whole_group = whole_group
        # a group of its own: the terminal's interrupt would end it without a checkpoint
        self.process = subprocess.Popen(
            words,
            env=variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            process_group=0,
        )
        #: Lines with the times at which they came.
        self.noted: list[tuple[float, str]] = []
        self.printed: list[tuple[float, str]] = []
        assert self.process.stdout is not None and self.process.stderr is not None
        self.readers = [_reader(self.process.stdout, self.printed), _reader(self.process.stderr, self.noted)]

    def watch(self, watcher: Watcher | None, progress: ShownProgress) -> str:
        """Waits for the end and gives what was printed; passes on what the program notes meanwhile."""
        display, passed = display_of(progress), 0
        try:
            while True:
                try:
                    self.process.wait(_PAUSE)
                    break
                except subprocess.TimeoutExpired:
                    seen = watcher.look() if watcher and progress else None
                    if seen:
                        display.show(seen)
                    passed = self._pass_on(passed, time.monotonic() - _HELD_BACK, bool(progress))
        except BaseException:
            self._stop()
            raise
        finally:
            display.end()
        for reader in self.readers:
            reader.join()
        self._judge()
        self._pass_on(passed, time.monotonic(), bool(progress))
        return _text(self.printed)

    def _pass_on(self, passed: int, until: float, wanted: bool) -> int:
        """Prints what the program has noted since, such as warnings, until a time; what mpirun says of its own is none of it."""
        lines = [line for moment, line in self.noted[passed:] if moment <= until]
        for line in lines if wanted else []:
            if line.startswith("turbid: "):
                print(line, end="", file=sys.stderr, flush=True)
        return passed + len(lines)

    def _stop(self) -> None:
        """Asks for a checkpoint and an end."""
        if self.process.poll() is None:
            if self.whole_group:
                os.killpg(self.process.pid, signal.SIGTERM)
            else:
                self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(60)
            except subprocess.TimeoutExpired:
                self.process.kill()

    def _judge(self) -> None:
        code, noted = self.process.returncode, _text(self.noted)
        if code == 0:
            return
        printed = _text(self.printed) + noted
        message = in_python(message_in(noted) or f"turbid ended with code {code}: {printed.strip() or 'it printed nothing'}")
        if code == _REFUSED:
            if self.folder is not None and _FINISHED in message:
                message += f"; turbid.open({str(self.folder)!r}) reads it"
            # who has given a dict has not written that file
            if self.written is not None:
                message = re.sub(rf"(\S*/)?{re.escape(self.written.name)}(:\d+)?: ", "", message)
            raise Refused(message, printed)
        number = signal_of(code, noted)
        if number is not None:
            message = self._killed(number)
        raise Failed(message, code, printed, number)

    def _killed(self, number: int) -> str:
        """What ended the program, and how to go on."""
        name = signal.Signals(number).name if number in set(signal.Signals) else "unknown"
        cause = ", as the system does where memory is short" if number == signal.SIGKILL else ""
        if self.folder is None:
            remedy = "start it again"
        elif (self.folder / "checkpoint.h5").exists():
            remedy = f"turbid.resume({str(self.folder)!r}) goes on from the last checkpoint"
        else:
            remedy = f"{self.folder} has no checkpoint yet: start it again"
        return f"turbid was ended by signal {number} ({name}{cause}); {remedy}"


def _reader(stream: IO[str], into: list[tuple[float, str]]) -> threading.Thread:
    def read() -> None:
        for line in iter(stream.readline, ""):
            into.append((time.monotonic(), line))

    thread = threading.Thread(target=read, daemon=True)
    thread.start()
    return thread


def _text(lines: list[tuple[float, str]]) -> str:
    return "".join(line for _, line in lines)


def signal_of(code: int, noted: str) -> int | None:
    """The signal that ended the program, or one of its ranks; ``None`` where it ended by itself."""
    if code < 0:
        return -code
    found = re.search(r"exited on signal (\d+)", noted)
    # ranks that one has called to end are not the cause
    return int(found[1]) if found and "MPI_ABORT" not in noted else None


def in_python(message: str) -> str:
    """A message of the command line in the words of this package."""
    message = re.sub(r"`turbid resume ([^`]*)`", lambda found: f"turbid.resume({found[1]!r})", message)
    message = re.sub(r"^--out (?=.+?: )", "out=", message)
    return re.sub(r"(?:turbid run )?--force\b", "force=True", message)


def message_in(noted: str) -> str | None:
    """The error among what was noted, without what mpirun adds."""
    own = re.split(r"^-{20,}$|^turbid: ", noted, flags=re.MULTILINE)
    heads = re.findall(r"^-{20,}$|^turbid: ", noted, flags=re.MULTILINE)
    errors = [text for head, text in zip(heads, own[1:]) if head == "turbid: " and not text.startswith("warning: ")]
    if errors:
        return errors[-1].strip()
    # words that the command line does not know
    return noted.strip() if noted.startswith("error: ") else None
