"""Every block of Python in the README and in docs/ runs as it stands.

The blocks of a page are run in order, in one namespace, in a folder that holds the
files of the demo study. So are the cells of notebooks, without Jupyter.
"""

import json
import re
import shlex
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
import typer

from clerestory.cli.program import program
from clerestory.study.new_study import write_demo

REPOSITORY = Path(__file__).parents[1]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SHELL = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)

PAGES = [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
NOTEBOOKS = sorted((REPOSITORY / "docs").rglob("*.ipynb"))
PAGES_WITH_CODE = [page for page in PAGES if BLOCK.search(page.read_text("utf-8"))]


def blocks(page):
    """Compiled blocks, whose tracebacks name the page and its line."""
    text = page.read_text("utf-8")
    for match in BLOCK.finditer(text):
        before = "\n" * text.count("\n", 0, match.start(1))
        yield compile(before + match[1], page, "exec")


@pytest.mark.parametrize("page", PAGES_WITH_CODE, ids=lambda page: page.name)
def test_python_runs_as_it_stands(page, tmp_path, monkeypatch):
    write_demo(tmp_path)
    monkeypatch.chdir(tmp_path)
    namespace = {"__name__": "__main__"}
    for block in blocks(page):
        exec(block, namespace)


@pytest.mark.slow
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.name)
def test_notebooks_run_as_they_stand(notebook, tmp_path, monkeypatch):
    write_demo(tmp_path)
    monkeypatch.chdir(tmp_path)
    mpl.use("agg")
    namespace = {"__name__": "__main__"}
    cells = json.loads(notebook.read_text("utf-8"))["cells"]
    for number, cell in enumerate(cells):
        if cell["cell_type"] == "code":
            source = "".join(cell["source"])
            exec(compile(source, f"{notebook.name}, cell {number}", "exec"), namespace)
    plt.close("all")
    # Both methods agree on a day behind a blind, within the noise of few samples
    difference = namespace["difference"]
    assert float(abs(difference).max()) < 0.05
    assert 0.2 < float(namespace["glare"]["five phases"].dgp.max()) < 0.5


def test_notebooks_are_stored_without_output():
    for notebook in NOTEBOOKS:
        cells = json.loads(notebook.read_text("utf-8"))["cells"]
        assert not any(cell.get("outputs") for cell in cells)


def test_the_readme_shows_python():
    assert REPOSITORY / "README.md" in PAGES_WITH_CODE


def shell_commands(page):
    """Words of each call of our program in the shell blocks of a page."""
    for match in SHELL.finditer(page.read_text("utf-8")):
        for line in match[1].replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True)
            if words and Path(words[0]).name == "clerestory":
                yield words[1:]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_have_the_options_that_pages_use(page):
    for words in shell_commands(page):
        command = typer.main.get_command(program())
        while words and words[0] in getattr(command, "commands", {}):
            command = command.commands[words.pop(0)]
        assert not hasattr(command, "commands"), f"not a command: {words}"
        known = {name for parameter in command.params for name in parameter.opts}
        used = {word for word in words if word.startswith("-")}
        assert used <= known | {"--help"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_between_pages_lead_somewhere(page):
    targets = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text("utf-8"))
    missing = [target for target in targets if not (page.parent / target).exists()]
    assert not missing
