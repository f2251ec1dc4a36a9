"""Notebooks and the examples of the manual run as they are."""

import json
import re
import tomllib
from pathlib import Path

import nbclient
import nbformat
import pytest

import turbid

PACKAGE = Path(__file__).parents[1]
NOTEBOOKS = sorted((PACKAGE / "notebooks").glob("*.ipynb"))
PAGE = PACKAGE.parent / "docs" / "python.md"


def test_there_are_notebooks():
    assert [path.stem for path in NOTEBOOKS] == ["first_run", "sweep", "viscosity"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    pictures = [output for cell in notebook.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]
    assert pictures and (tmp_path / "out").is_dir()


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_what_a_notebook_keeps_is_small_and_of_no_machine(path):
    notebook = json.loads(path.read_text())
    for cell in notebook["cells"]:
        for output in cell.get("outputs", []):
            assert output.get("output_type") != "error" and output.get("name") != "stderr"
            assert len(output.get("data", {}).get("image/png", "")) < 200_000, "pictures take less than 150 kB"
            assert not re.search(r"/(home|work|root|tmp)/", json.dumps(output))


def test_the_page_of_the_manual_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) > 5
    (tmp_path / "shear.toml").write_text((PACKAGE / "tests" / "page.toml").read_text())
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, f"docs/python.md: {block.splitlines()[0]}", "exec"), names)


@pytest.mark.parametrize("path", [PAGE, PACKAGE / "README.md"], ids=lambda path: path.stem)
def test_pages_name_what_there_is(path):
    page = path.read_text(encoding="utf-8")
    for pattern, owner in ((r"\bturbid\.(\w+)", turbid), (r"\brun\.(\w+)", turbid.Run), (r"\bframe\.(\w+)", turbid.Frame)):
        for name in set(re.findall(pattern, page)) - {"git", "com"}:
            assert hasattr(owner, name) or name == "folder", f"{path.name} names {name}"


def test_the_version_is_one():
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text())["project"]
    cargo = tomllib.loads((PACKAGE.parent / "Cargo.toml").read_text())["package"]
    assert project["version"] == turbid.__version__ == cargo["version"]
