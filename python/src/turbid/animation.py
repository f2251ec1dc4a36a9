"""An animation that a notebook shows."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from pathlib import Path

_FILMS = {".mp4": "video/mp4", ".webm": "video/webm"}
_PICTURES = {".png": "image/png", ".apng": "image/png", ".gif": "image/gif"}
# a notebook keeps what it shows
_MOST_BYTES = 20_000_000


@dataclass(frozen=True)
class Animation:
    """A file with an animation.

    Attributes:
        path: Where it is.
    """

    path: Path

    def __fspath__(self) -> str:
        return str(self.path)

    def _repr_html_(self) -> str:
        kind = _FILMS.get(self.path.suffix) or _PICTURES.get(self.path.suffix)
        if kind is None or self.path.stat().st_size > _MOST_BYTES:
            return f"<code>{self.path}</code>"
        data = base64.b64encode(self.path.read_bytes()).decode()
        source = f"src='data:{kind};base64,{data}'"
        return f"<video controls loop {source}></video>" if kind.startswith("video") else f"<img {source} alt='animation of a run'>"
