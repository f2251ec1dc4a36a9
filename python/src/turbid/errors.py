"""What can go wrong."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path


class TurbidError(Exception):
    """Anything that this package raises of its own."""


class Missing(TurbidError, LookupError):
    """A folder that is no run, or something that a run does not have (yet); the message says what would make it."""


class OutOfRange(Missing, IndexError):
    """A place in a sequence of a run that has fewer members; the message says how many there are."""


class Invalid(TurbidError, ValueError, TypeError):
    """An argument that cannot be used; the message names it, its value and what would be right."""


class Damaged(TurbidError, RuntimeError):
    """A file of a run that is there but cannot be read.

    Attributes:
        path: The file.
    """

    def __init__(self, path: Path, reason: object) -> None:
        super().__init__(f"{path} is damaged ({reason}); put back a copy of it, or make the run anew with turbid.run(.., force=True)")
        self.path = path


class Failed(TurbidError, RuntimeError):
    """The program could not be started, or ended with an error that is no refusal.

    Attributes:
        code: Exit code of the program; ``None`` where it could not be started.
        printed: All that it printed.
        signal: Number of the signal that ended it; ``None`` where none did.
    """

    def __init__(self, message: str, code: int | None = None, printed: str = "", signal: int | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.printed = printed
        self.signal = signal


class Refused(TurbidError, ValueError):
    """The program refuses a scene, an override or a folder before it computes anything. The text is its whole message.

    Attributes:
        key: The key that is wrong, written ``bodies[0].radius``, where the message names one.
        value: Its value as it was written; ``None`` where the key itself is missing or unknown.
        remedy: What is wrong and what would be right.
        file: The file that it was read from; ``None`` for overrides and for scenes given as a ``dict``.
        line: Number of the line in it, from 1.
        override: Whether it was an override (``set=``) that is refused.
        printed: All that the program printed.
    """

    def __init__(self, message: str, printed: str = "") -> None:
        super().__init__(message)
        parts = _Parts.of(message)
        self.key = parts.key
        self.value = parts.value
        self.remedy = parts.remedy
        self.file = parts.file
        self.line = parts.line
        self.override = parts.override
        self.printed = printed


_OVERRIDE = re.compile(r'--set(?: "(?:[^"\\]|\\.)*")?: ')
_FOLDER = re.compile(r"(?:--out |out=)(?P<file>.+?): ")
_LINE = re.compile(r"(?P<file>[^:\n]+):(?P<line>\d+): ")
_FILE = re.compile(r"(?P<file>[^:\s=]*[./][^:\s=]*): ")
_KEY = r"[A-Za-z_][\w\-]*(?:\[\d+\]|\.[\w\-]+)*"
_VALUE = re.compile(rf'(?P<key>{_KEY}) = (?P<value>"(?:[^"\\]|\\.)*"|.*?): (?P<rest>.*)', re.DOTALL)
_NAMED = re.compile(rf"(?:unknown|missing) key (?P<key>{_KEY})")
_CHOICE = re.compile(rf"(?P<key>{_KEY}) needs one of ")


@dataclass
class _Parts:
    """The parts of a message ``place: key = value: remedy``."""

    remedy: str
    key: str | None = None
    value: str | None = None
    file: str | None = None
    line: int | None = None
    override: bool = False

    @staticmethod
    def of(message: str) -> _Parts:
        parts = _Parts(message)
        if found := _OVERRIDE.match(message):
            parts.override = True
        elif found := (_FOLDER.match(message) or _LINE.match(message) or _FILE.match(message)):
            place = found.groupdict()
            parts.file = place["file"]
            parts.line = int(place["line"]) if place.get("line") else None
        parts.remedy = message[found.end() :] if found else message
        if found := _VALUE.match(parts.remedy):
            parts.key, parts.value, parts.remedy = found["key"], found["value"], found["rest"]
        elif found := (_NAMED.match(parts.remedy) or _CHOICE.match(parts.remedy)):
            parts.key = found["key"]
        return parts
