"""A law in C in the working folder, and a scenario that is controlled by it."""

from pathlib import Path

from bridge.scenario import Scenario, load
from tests.support.processes import ROOT

HEAD = """\
#include <math.h>
#include "hydrotwin_law.h"
"""
VERSION = "const int32_t hydrotwin_law_version = HYDROTWIN_LAW_VERSION;\n"
LAW = """
int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals) {
%s
}
"""


def written(body: str, more: str = "", head: str = HEAD + VERSION) -> None:
    """The law of the working folder."""
    Path("law.c").write_text(head + more + LAW % body)


def scenario(*changes: str) -> Scenario:
    return load("step", ["controller.kind=c", "controller.source=law.c", "duration=0.3", *changes])


def page(language: str) -> str:
    """The example of docs/running.md."""
    section = (ROOT / "docs/running.md").read_text(encoding="utf-8").partition("## A law in C")[2]
    return section.partition(f"```{language}\n")[2].partition("```")[0]
