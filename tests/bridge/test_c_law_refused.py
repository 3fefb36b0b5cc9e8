"""A law in C that cannot be one: each mistake in one line, before the run."""

import shutil
from pathlib import Path

import pytest

from bridge.errors import ScenarioError
from bridge.runs.run import ready_to_run
from tests.support.c_law import HEAD, LAW, VERSION, scenario, written

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler `cc` on this machine")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refusal(*changes: str) -> str:
    with pytest.raises(ScenarioError) as raised:
        ready_to_run(scenario(*changes))
    assert "\n" not in str(raised.value)
    return str(raised.value)


ZERO = "*spool = 0; return 0;"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEAD + LAW % ZERO, "exports no hydrotwin_law_version, so it is not a law: include hydrotwin_law.h"),
        (
            HEAD + "const int32_t hydrotwin_law_version = 2;" + LAW % ZERO,
            "is of version 2 of hydrotwin_law.h, this is 1",
        ),
        (HEAD + VERSION, "exports no function hydrotwin_law: define it"),
        (HEAD + VERSION + LAW % "*spool = 0 return 0;", "does not compile: law.c:7:"),
        (HEAD + VERSION + LAW % "*spool = forgotten(1.0); return 0;", "does not compile: law.c:7:"),
        (HEAD + VERSION + "int other(void);" + LAW % "*spool = other(); return 0;", "undefined symbol: other"),
        ('#include "model.h"\n', "does not compile: law.c:1:10: fatal error: "),
        (HEAD + VERSION + "const int32_t hydrotwin_law_memory = -1;" + LAW % ZERO, "asks for -1 numbers of memory"),
        (
            HEAD + VERSION + 'const char *const hydrotwin_law_parameters[] = {"k p", 0};' + LAW % ZERO,
            "has a name 'k p': names are letters",
        ),
    ],
)
def test_a_library_that_is_not_a_law_is_refused_in_one_line(text: str, said: str):
    Path("law.c").write_text(text)
    assert said in refusal()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([], "controller.parameters.gain: controller.source 'law.c' needs it"),
        (["gain=1", "gian=1"], "gian: controller.source 'law.c' has none of this name; did you mean 'gain'?"),
    ],
)
def test_parameters_are_those_that_the_law_names(changes: list[str], said: str):
    written(ZERO, 'const char *const hydrotwin_law_parameters[] = {"gain", 0};\n')
    assert said in refusal(*(f"controller.parameters.{change}" for change in changes))


def test_a_law_without_parameters_takes_none():
    written(ZERO)
    assert "has none of this name, nor any other" in refusal("controller.parameters.gain=1")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["controller.library=law.so"], "controller.library or as controller.source, one of the two"),
        (["controller.source="], "controller.library or as controller.source, one of the two"),
        (["controller.source=law.cpp"], "'law.cpp' is not a C file; compile it yourself"),
        (["controller.parameters.a=fast"], "a = 'fast': a law in C takes numbers"),
        (["controller.parameters.a=[1, 2]"], "a = [1, 2]: a law in C takes numbers"),
        (["controller.parameters.a=1 furlong"], "unit 'furlong' is unknown"),
        (["controller.gain=1"], "kind 'c' does not have it, but 'pd'"),
    ],
)
def test_a_scenario_that_does_not_fit_is_refused_in_one_line(changes: list[str], said: str):
    assert said in refusal(*changes)


def test_a_file_that_is_missing_or_not_a_library_is_refused():
    assert "controller.source 'law.c': there is no such file beside the scenario" in refusal()
    Path("law.so").write_text("no library")
    said = refusal("controller.source=", "controller.library=law.so")
    assert said.startswith("controller.library 'law.so' cannot be loaded: ")
    assert "/tmp" not in said


def test_without_a_compiler_one_sentence_says_so(monkeypatch: pytest.MonkeyPatch):
    written(ZERO)
    monkeypatch.setenv("CC", "nobody -O3")
    assert refusal() == (
        "controller.source 'law.c': there is no C compiler 'nobody' on this machine; install one (gcc or clang), "
        "or give a compiled library as controller.library"
    )
