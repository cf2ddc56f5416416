"""The pages: links lead somewhere, commands and options exist, examples run, every public name is told."""

import ast
import inspect
import re
import shlex
from importlib.metadata import version
from pathlib import Path

import pytest
from typer.main import get_command

import fieldline

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")])
UNIT_OR_SHAPE = re.compile(r"\[[^\]]*\]|\([^)]*(?:\.\.\.|n|\d)[^)]*\)|unit|Dataset")
named = {"ids": lambda path: str(path.relative_to(ROOT))}


def blocks(page: Path, language: str = "") -> list[str]:
    """Fenced blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def anchor(heading: str) -> str:
    """What a heading is linked by."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, **named)
def test_links_lead_somewhere(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, part = target.partition("#")
        place = (page.parent / path).resolve() if path else page
        assert place.exists(), f"{page.name} links to {target}"
        if part:
            headings = re.findall(r"^#+ (.*)$", place.read_text(encoding="utf-8"), re.MULTILINE)
            assert part in map(anchor, headings), f"{page.name} links to {target}"


def test_every_page_is_in_the_index():
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    for page in PAGES:
        if page.name not in ("index.md", "README.md", "CHANGELOG.md"):
            assert str(page.relative_to(ROOT / "docs")) in index


@pytest.mark.parametrize("page", PAGES, **named)
def test_commands_and_options_exist(page):
    from fieldline.cli.app import app

    commands = get_command(app).commands
    lines = [line.split("#")[0] for block in blocks(page, "[a-z]*") for line in block.splitlines()]
    told = [re.split(r"\s{3,}", line.strip())[0] for line in lines if re.match(r"(\$ )?fieldline [a-z]", line.strip())]
    told += [code for code in re.findall(r"`(fieldline [a-z][^`]*)`", page.read_text(encoding="utf-8"))]
    for line in told:
        words = shlex.split(line.removeprefix("$ "))
        assert words[1] in commands, line
        command = commands[words[1]]
        command = command.commands[words[2]] if hasattr(command, "commands") and len(words) > 2 else command
        known = {option for parameter in command.params for option in parameter.opts}
        unknown = {word.split("=")[0] for word in words[2:] if word.startswith("--")} - known - {"--help", "--debug"}
        assert not unknown, line


def test_make_has_the_commands_of_the_readme():
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    told = re.findall(r"(?:^ {4}|`)make ([a-z]+)", readme, re.MULTILINE)
    assert {"demo", "test"} <= set(told) <= set(targets)


@pytest.mark.parametrize("page", PAGES, **named)
def test_examples_in_python_are_python_and_name_what_exists(page):
    for block in blocks(page, "python"):
        tree = ast.parse(block)
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "fl":
                assert node.attr in fieldline.__all__, f"fl.{node.attr}"
            if isinstance(node, ast.ImportFrom) and node.module.startswith("fieldline"):
                exec(compile(ast.Module([node], []), page.name, "exec"), {})


def test_the_example_of_the_conventions_holds():
    (example,) = blocks(ROOT / "docs" / "conventions.md", "python")
    exec(compile(example, "conventions.md", "exec"), {})


@pytest.mark.parametrize("name", [name for name in fieldline.__all__ if name != "__version__"])
def test_every_public_name_is_documented(name):
    thing = getattr(fieldline, name)
    text = inspect.getdoc(thing)
    assert text and len(text) > 20
    own = {} if not inspect.isfunction(thing) else inspect.signature(thing).parameters
    for argument, parameter in own.items():
        assert parameter.kind is not inspect.Parameter.VAR_KEYWORD or name == "field_model", f"{name}(**{argument})"
        assert re.search(rf"\b{argument}\b|arguments as `", text), f"{name} does not tell of {argument}"
    if not issubclass(thing if inspect.isclass(thing) else object, Exception):
        assert UNIT_OR_SHAPE.search(text), f"{name} tells neither unit nor shape"
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    assert f"`{name}`" in index


def test_the_version_is_told_once():
    assert fieldline.__version__ == version("fieldline")
    assert f"## {fieldline.__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_nothing_in_the_repository_is_of_one_machine():
    pattern = re.compile(r"(?<![\w.])/(?:home|root|Users|work)/\w")
    kinds = ("*.md", "*.toml", "Makefile", ".ci/run", "benchmarks/*.py", "docs/**/*.py", "tests/**/*.py")
    found = {path for kind in kinds for path in ROOT.glob(kind)} | set(PAGES)
    assert len(found) > 50
    bad = [str(path.relative_to(ROOT)) for path in found if pattern.search(path.read_text(encoding="utf-8"))]
    assert bad == []
