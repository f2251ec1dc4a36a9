"""A run as a small table in a notebook."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .results import Run

# more forces than this make a table that nobody reads
_MOST_BODIES = 4


def html_of(run: Run) -> str:
    """The answer first, then what it is the answer to."""
    title = run.scene.get("title", run.name) if (run.folder / "scene.toml").exists() else run.name
    rows = [
        ("state", run.state),
        *_viscosity(run),
        *(_answers(run.summary) if run.finished else []),
        ("frames", str(len(run.frames))),
        ("folder", str(run.folder)),
    ]
    cells = "".join(f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(text)}</td></tr>" for name, text in rows)
    return f"<table><caption style='text-align:left'><b>{escape(str(title))}</b></caption>{cells}</table>"


def _viscosity(run: Run) -> list[tuple[str, str]]:
    from .errors import Missing

    try:
        found = run.viscosity
    except Missing:
        return []
    parts = ", ".join(f"{name} {value:.4g}" for name, value in (found.mean_parts or found.parts).items() if value)
    rows = [("relative viscosity", str(found) + (" (mean, 95 %)" if found.mean is not None else ""))]
    return rows + [("of which", parts)] if "," in parts else rows


def _answers(summary: dict[str, Any]) -> list[tuple[str, str]]:
    rows = []
    count = len(summary["bodies"]) + (summary.get("other_bodies") or 0)
    rows.append(("bodies", f"{count}, fraction {summary['fraction']:.4g}"))
    scalar = summary.get("scalar") or {}
    if conduction := scalar.get("conduction"):
        rows.append(("conductivity", f"{conduction['conductivity']:.6g}"))
    for number, inclusion in enumerate(scalar.get("inclusions", [])[:_MOST_BODIES]):
        rows.append((f"value in body {number}", f"{inclusion['value']:.6g}"))
    if not scalar and count <= _MOST_BODIES:
        rows += [(f"force on body {number}", _vector(body["force"])) for number, body in enumerate(summary["bodies"])]
        rows += [(f"velocity of body {number}", _vector(body["velocity"])) for number, body in enumerate(summary["bodies"])]
    contact = summary.get("contact") or {}
    if contact.get("smallest_gap") is not None:
        rows.append(("contacts", f"{contact['active']} that bear a force, smallest gap {contact['smallest_gap']:.2g} radii"))
    seconds = (summary.get("motion") or {}).get("seconds")
    effort = f"{summary['steps']} steps in {seconds:.3g} s on {summary['ranks']} ranks" if seconds else f"{summary['ranks']} ranks"
    return [*rows, ("effort", effort)]


def _vector(components: list[float]) -> str:
    return "(" + ", ".join(f"{component:.5g}" for component in components) + ")"
