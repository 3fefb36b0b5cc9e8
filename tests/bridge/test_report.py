"""The report: one page that fetches nothing, says what the recording says, and shows where two runs differ."""

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from bridge.drawing.thin import thinned
from bridge.errors import RunError, UsageError
from bridge.report.difference import metric_rows, parameter_rows, signal_differences
from bridge.report.page import page, write_report
from bridge.report.subject import Run, load_run, named_apart
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.scenario.bands import METRICS, value_with_unit
from bridge.scenario.describe import shown_values, slots_of

SHORT = ["duration=1.6"]
FETCHING = {"src", "href", "xlink:href", "data", "action", "srcset", "poster"}


class Page(HTMLParser):
    """What stands in a page: tags, sections, cells of tables, text, and what would be fetched."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.sections: list[str] = []
        self.words: list[str] = []
        self.rows: list[list[str]] = []
        self.fetched: list[str] = []
        self.ids: list[str] = []
        self._cell = False
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        named = dict(attrs)
        if tag in ("section", "footer"):
            self.sections.append(named["id"] or "")
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        self._cell = tag in ("td", "th") or (self._cell and tag in ("b", "span"))
        self.ids += [value for name, value in attrs if name == "id" and value]
        self.fetched += [v for name, v in attrs if name in FETCHING and v and not v.startswith(("#", "data:"))]

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self._cell = False

    def handle_data(self, data):
        self.words.append(data)
        if self._cell:
            self.rows[-1][-1] += data


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A step, the same with another gain, and the pick-up of a weight."""
    folder = tmp_path_factory.mktemp("report")
    changed = [*SHORT, "controller.gain=0.5 V/%", 'rig.load.mass="130 kg"']
    chosen = {"step": ("step", SHORT), "weaker": ("step", changed), "weight": ("load-change", SHORT)}
    return [
        record_in_process(load(name, changes), folder / f"{file}.mcap").path for file, (name, changes) in chosen.items()
    ]


def unled(folder: Path, *changes: str) -> Path:
    """A short run without a loop: no chart of its stability takes time."""
    scenario = load("step", ["duration=0.1", "controller.kind=open-loop", *changes])
    return record_in_process(scenario, folder / "unled.mcap").path


@pytest.fixture(scope="module")
def single(runs: list[Path]) -> tuple[Run, str, Page]:
    run = load_run(runs[2])
    html = page([run])
    return run, html, Page(html)


def test_nothing_is_fetched(single):
    _, html, parsed = single
    assert parsed.fetched == []
    assert not re.findall(r"(?:https?:)?//[a-z]", re.sub(r"data:image/png;base64,[\w+/=\s]+", "", html))
    assert not {"script", "link", "iframe", "object", "embed"} & set(parsed.tags)
    assert "@import" not in html


def test_ids_are_one_of_a_kind_so_that_pictures_do_not_mix(single):
    _, html, parsed = single
    assert len(parsed.ids) == len(set(parsed.ids))
    used = set(re.findall(r'(?:href="|url\()#([^")]+)', html))
    assert used <= set(parsed.ids)


def test_all_sections_are_there_in_order(single):
    assert single[2].sections == [
        *("metrics", "position", "pressure", "valve", "flow", "relief", "cavities", "map1"),
        *("events", "circuit", "parameters", "scenario", "origin"),
    ]


def test_every_axis_names_its_unit(single):
    words = [word for word in single[2].words if word.strip()]
    for axis in ("position [mm]", "pressure [bar]", "valve [of travel]", "flow [l/min]", "lift [um]", "vapour [cm³]"):
        assert axis in words
    assert words.count("time [s]") == 7
    assert [f"pipe {i} [m]" in words for i in range(1, 7)] == [True] * 6


def test_metrics_and_bands_are_those_of_the_run(single):
    run, _, parsed = single
    for name, value in run.summary.metrics._asdict().items():
        if value == value:
            assert [METRICS[name].words, value_with_unit(name, value)] in parsed.rows
    for verdict in run.verdicts:
        assert [verdict.text, verdict.found, "passed" if verdict.passed else "FAILED"] in parsed.rows
    assert len(run.verdicts) == 14


def test_every_parameter_stands_with_its_source_and_changes_are_marked(single):
    run, _, parsed = single
    cells = [row[1:] for row in parsed.rows if len(row) == 4]
    for value in shown_values(run.scenario):
        mark = "* " if value.changed else ""
        assert [value.name.partition(".")[2].replace("_", " "), mark + value.value, value.source] in cells
    assert any(value.changed for value in shown_values(run.scenario))


def test_what_is_fitted_stands_as_a_picture_and_slot_by_slot(single):
    run, _, parsed = single
    assert {"relief valve, two stages", "line 3: hose, 2.05 m", "183 kg on a support:"} <= set(parsed.words)
    for slot, words, _ in slots_of(run.scenario):
        assert [slot, words] in parsed.rows


def test_events_stand_with_their_time(single):
    assert ["1.600 s", "ended", "complete after 1600 ticks"] in single[2].rows


def test_it_is_a_page_for_paper_too(single):
    assert "@media print" in single[1]
    assert "@page { size: A4" in single[1]


def test_names_of_people_are_text_and_no_markup(tmp_path: Path):
    html = page([load_run(unled(tmp_path, "title=<b>&amp; me"))])
    assert "<b>&amp; me" not in html
    assert "<b>&amp; me" in "".join(Page(html).words)


def test_two_runs_are_compared(runs: list[Path], tmp_path: Path):
    both = [load_run(path) for path in runs[:2]]
    parsed = Page(write_report(runs[:2], tmp_path / "two.html").read_text())
    assert "differences" in parsed.sections
    assert {"map1", "map2"} <= set(parsed.sections)
    assert ["load.mass", "120 kg", "130 kg"] in parsed.rows
    found = {row[0]: row for row in parsed.rows if len(row) == 5}
    apart = np.abs(both[0].state["p_lower"] - both[1].state["p_lower"]) / 1e5
    assert found["p_lower"][1] == f"{apart.max():.4g} bar"
    assert found["p_lower"][3] == f"{np.sqrt(np.mean(apart**2)):.4g} bar"


def test_a_run_does_not_differ_from_itself(runs: list[Path]):
    run = load_run(runs[0])
    assert all(d.greatest == d.rms == 0.0 and d.first is None for d in signal_differences(run, run))
    assert parameter_rows([run, run]) == []
    assert all(row[-1] == "same" or row[-1] == "-" for row in metric_rows([run, run]))
    assert named_apart([run, run]) == ["step (1)", "step (2)"]


def test_the_first_difference_is_found_where_it_is(runs: list[Path]):
    """Another mass tells at once; another gain not before the reference steps, at 1 s, and the command acts."""
    found = {d.signal: d for d in signal_differences(load_run(runs[0]), load_run(runs[1]))}
    assert found["p_lower"].first == 0.0
    spool = found["spool"]
    assert spool.first is not None
    assert spool.at is not None
    assert spool.at >= 1.0


def test_a_thinned_curve_keeps_its_peaks_and_its_mean():
    time = np.linspace(0.0, 1.0, 20_001)
    values = np.sin(40.0 * time)
    values[7777] = 9.0
    course = thinned(time, values)
    assert len(course.time) <= 900
    assert course.greatest.max() == 9.0
    assert course.least.min() == values.min()
    assert course.mean.mean() == pytest.approx(values.mean(), abs=1e-3)
    assert thinned(time[:50], values[:50]).mean.tolist() == values[:50].tolist()


def test_what_cannot_be_reported_gets_one_line(tmp_path: Path):
    runs = [unled(tmp_path)]
    empty = tmp_path / "a.mcap"
    empty.write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(UsageError, match="nothing to report"):
        write_report([empty], tmp_path / "a.html")
    with pytest.raises(UsageError, match=r"name it .*\.html"):
        write_report(runs, tmp_path / "a.pdf")
    (tmp_path / "file").write_text("")
    with pytest.raises(RunError, match="cannot be written"):
        write_report(runs, tmp_path / "file" / "a.html")
