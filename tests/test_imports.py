"""Imports run one way: bridge -> controller -> twin; the pure packages touch neither clock, network nor disk."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = ("twin", "controller", "bridge")
ALLOWED = {"twin": {"twin"}, "controller": {"controller", "twin"}, "bridge": set(OURS)}
LAWS = ("law", "reference", "hold", "metrics", "grid")
IMPURE = {"time", "socket", "subprocess", "zenoh", "mcap", "rich", "typer", "threading", "datetime", "random"}


def imported(path: Path) -> Iterator[str]:
    """Every module that a file imports, anywhere in it."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield node.module or ""


@pytest.mark.parametrize("package", OURS)
def test_imports_run_one_way(package: str):
    for path in (ROOT / package).rglob("*.py"):
        inner = {name.split(".")[0] for name in imported(path)} & set(OURS)
        assert inner <= ALLOWED[package], f"{path.relative_to(ROOT)} imports {inner - ALLOWED[package]}"


@pytest.mark.parametrize("package", ["twin", "controller"])
def test_the_core_knows_no_clock_network_or_screen(package: str):
    for path in (ROOT / package).rglob("*.py"):
        found = {name.split(".")[0] for name in imported(path)} & IMPURE
        assert not found, f"{path.relative_to(ROOT)} imports {found}"


@pytest.mark.parametrize("name", LAWS)
def test_control_laws_need_nothing_of_the_plant(name: str):
    assert not any(module.startswith("twin") for module in imported(ROOT / "controller" / f"{name}.py"))
