"""The rules that keep the rooms apart: import contracts, who may touch Qt, sockets and the disk, and sizes."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "qmd_studio"
MODULES = sorted(PACKAGE.rglob("*.py"))
MAX_LINES = 400
EMPTY_NAMES = {"utils", "util", "helpers", "helper", "common", "misc", "manager"}


def name_of(module: Path) -> str:
    return str(module.relative_to(ROOT))


def imports_of(module: Path) -> Iterator[str]:
    """Every module that is imported anywhere in the file, also inside functions."""
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def importers_of(*packages: str) -> set[str]:
    return {name_of(module) for module in MODULES for name in imports_of(module) if name.split(".")[0] in packages}


def writes_in(module: Path) -> list[int]:
    """The lines that write a file: `open` with a writing mode, `write_bytes`, `write_text`, a temporary file.

    What is opened on a name that only ever held `io.BytesIO()` is memory and no file.
    """
    lines = []
    tree = ast.parse(module.read_text(encoding="utf-8"))
    memory = names_of_memory(tree)
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if node.args and isinstance(node.args[0], ast.Name) and node.args[0].id in memory:
            continue
        arguments = [*node.args, *(k.value for k in node.keywords)]
        words = [a.value for a in arguments if isinstance(a, ast.Constant) and isinstance(a.value, str)]
        opens_to_write = called == "open" and any(re.fullmatch(r"[rbt]*[wax+][rbt+]*", word) for word in words)
        if opens_to_write or called in {"write_bytes", "write_text", "mkstemp", "NamedTemporaryFile"}:
            lines.append(node.lineno)
    return lines


def names_of_memory(tree: ast.AST) -> set[str]:
    assigned = [node for node in ast.walk(tree) if isinstance(node, ast.Assign)]
    held: dict[str, set[str]] = {}
    for node in assigned:
        for target in node.targets:
            if isinstance(target, ast.Name):
                held.setdefault(target.id, set()).add(ast.unparse(node.value))
    return {name for name, values in held.items() if values == {"io.BytesIO()"}}


def test_import_contracts_hold() -> None:
    lint_imports = Path(sys.executable).with_name("lint-imports")
    if not lint_imports.exists():
        pytest.skip("import-linter is not installed beside this Python")
    run = subprocess.run([lint_imports, "--no-cache"], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stdout + run.stderr


def test_qt_is_imported_by_the_window_only() -> None:
    strangers = {name for name in importers_of("PySide6", "pyqtgraph") if not name.startswith("qmd_studio/ui/")}
    assert not strangers


def test_sockets_are_opened_by_the_network_modules_only() -> None:
    allowed = ("qmd_studio/streaming/udp", "qmd_studio/streaming/wide_area")
    strangers = {name for name in importers_of("socket", "socketserver", "asyncio") if not name.startswith(allowed)}
    assert not strangers


def test_files_are_written_through_storage_only() -> None:
    writers = {name_of(module): writes_in(module) for module in MODULES if module.name != "storage.py"}
    assert {name: lines for name, lines in writers.items() if lines} == {}


def test_the_search_for_writers_finds_them(tmp_path: Path) -> None:
    module = tmp_path / "writer.py"
    module.write_text('open(p)\nopen(p, "w")\nopen(p, "rb")\nPath(p).open(mode="ab")\nPath(p).write_text("x")\n')
    assert writes_in(module) == [2, 4, 5]
    module.write_text('m = io.BytesIO()\nav.open(m, "w")\nn = io.BytesIO()\nn = path\nav.open(n, "w")\n')
    assert writes_in(module) == [5]


@pytest.mark.parametrize("module", MODULES, ids=name_of)
def test_a_module_is_small(module: Path) -> None:
    assert len(module.read_text(encoding="utf-8").splitlines()) <= MAX_LINES


def test_no_module_has_an_empty_name() -> None:
    assert not [name_of(module) for module in MODULES if {module.stem, module.parent.name} & EMPTY_NAMES]
