"""The sections of a report that are words and tables."""

from itertools import groupby

from bridge.drawing.html import svg, table, text
from bridge.figures.circuit.rig import draw_drive
from bridge.recording.told import events_of
from bridge.recording.words import sentence
from bridge.report.charts import RUNS
from bridge.report.difference import metric_rows, parameter_rows, scenario_rows, signal_differences
from bridge.report.subject import Run
from bridge.scenario.circuit import circuit_of
from bridge.scenario.describe import Value, shown_values, slots_of

MOST_EVENTS = 200  # in the table; the rest are counted


def head(runs: list[Run], names: list[str]) -> str:
    """Title, verdict and one sentence per run."""
    title = runs[0].scenario.title or runs[0].scenario.name
    if len(runs) > 1:
        title = " compared with ".join(names) if len(runs) == 2 else f"{len(runs)} runs compared"
    lines = []
    for run, name, colour in zip(runs, names, RUNS * len(runs), strict=False):
        key = f'<span class="key" style="background:{colour}"></span> <b>{text(name)}</b>. ' if len(runs) > 1 else ""
        lines.append(f'<p class="lead">{key}{text(sentence(run.recording))} {_badge(run)}</p>')
        lines += [f'<p class="failed">{text(fault)}</p>' for fault in run.faults]
    return f"<header><h1>{text(title)}</h1>{''.join(lines)}</header>\n"


def _badge(run: Run) -> str:
    if not run.verdicts and not run.faults:
        return '<span class="badge none">nothing expected</span>'
    met = sum(verdict.passed for verdict in run.verdicts)
    words = f"{met} of {len(run.verdicts)} bands met" + ("; the run failed" if run.faults else "")
    return f'<span class="badge {"good" if run.passed else "bad"}">{words}</span>'


def metrics(runs: list[Run], names: list[str]) -> str:
    """What the runs came to, and the bands they were to keep."""
    heads = ["metric", *map(text, names)] + (["difference"] if len(runs) == 2 else [])
    rows = [[text(cell) for cell in row] for row in metric_rows(runs)]
    parts = [f"<section id='metrics'><h2>Metrics</h2>{table(heads, rows, 'numbers')}"]
    for run, name in zip(runs, names, strict=True):
        if run.verdicts:
            title = "expected" + (f" of {text(name)}" if len(runs) > 1 else "")
            bands = [(text(v.words), text(v.found), _mark(v.passed)) for v in run.verdicts]
            parts.append(table((title, "found", ""), bands, "bands"))
    return "".join(parts) + "</section>\n"


def _mark(passed: bool) -> str:
    return f'<span class="{"passed" if passed else "failed"}">{"passed" if passed else "FAILED"}</span>'


def differences(runs: list[Run], names: list[str]) -> str:
    """Each run against the first: parameters that differ, then every signal."""
    heads = ("parameter", *map(text, names))
    rows = [[text(cell) for cell in row] for row in parameter_rows(runs)]
    parts = ["<section id='differences'><h2>Differences</h2>"]
    parts.append(table(heads, rows, "numbers") if rows else "<p>All parameters are the same.</p>")
    for run, name in zip(runs[1:], names[1:], strict=True):
        found = signal_differences(runs[0], run)
        body = [
            (
                text(d.signal),
                f"{d.greatest:.4g} {text(d.unit)}",
                "-" if d.at is None else f"{d.at:.3f} s",
                f"{d.rms:.4g} {text(d.unit)}",
                "never" if d.first is None else f"{d.first:.3f} s",
            )
            for d in found
        ]
        heads = (f"{text(name)} less {text(names[0])}", "greatest difference", "at", "rms", "first different")
        parts.append(table(heads, body, "numbers") if body else "<p>The runs have no instant in common.</p>")
    return "".join(parts) + "</section>\n"


def timing_table(runs: list[Run], names: list[str]) -> str:
    """Percentiles of wall times, overruns."""
    rows = []
    for run, name in zip(runs, names, strict=True):
        lead = f"{text(name)}: " if len(runs) > 1 else ""
        for words, spread in run.summary.timing.shown() if run.summary.timing else ():
            rows.append((lead + words, *(f"{value * 1e6:.1f} us" for value in spread)))
    return table(("wall time", "p50", "p99", "p99.9", "greatest"), rows, "numbers")


def events(runs: list[Run], names: list[str]) -> str:
    """What happened, in the order in which it did."""
    rows, left = [], 0
    for run, name in zip(runs, names, strict=True):
        found = events_of(run.recording)
        left += max(0, len(found) - MOST_EVENTS)
        lead = (text(name),) if len(runs) > 1 else ()
        rows += [(*lead, f"{e.stamp / 1e9:.3f} s", text(e.kind), text(e.text)) for e in found[:MOST_EVENTS]]
    heads = (*(("run",) if len(runs) > 1 else ()), "time", "what", "")
    more = f"<p class='soft'>{left} more events are in the recordings.</p>" if left else ""
    return f"<section id='events'><h2>Events</h2>{table(heads, rows, 'numbers')}{more}</section>\n"


def circuit(runs: list[Run], names: list[str]) -> str:
    """What is fitted, as a picture and slot by slot; of the first run where all have the same."""
    parts = ["<section id='circuit'><h2>Circuit</h2>"]
    slots = [slots_of(run.scenario) for run in runs]
    alike = all(found == slots[0] for found in slots)
    for run, name, found in list(zip(runs, names, slots, strict=True))[: 1 if alike else None]:
        if not alike:
            parts.append(f"<p><b>{text(name)}</b></p>")
        drawn = draw_drive(run.scenario.rig_values(), circuit_of(run.scenario))
        parts.append(f"<figure>{svg(drawn, f'circuit{len(parts)}', f'Circuit of {name}')}</figure>")
        parts.append(
            table(("slot", "what is fitted"), [(text(slot), text(words)) for slot, words, _ in found], "fitted")
        )
    return "".join(parts) + "</section>\n"


def parameters(runs: list[Run], names: list[str]) -> str:
    """The numbers of what is fitted, with their sources; of the first run where they are the same in all."""
    parts = ["<section id='parameters'><h2>Parameters of the rig</h2>"]
    found = [shown_values(run.scenario) for run in runs]
    alike = all(values == found[0] for values in found)
    for values, name in list(zip(found, names, strict=True))[: 1 if alike else None]:
        if not alike:
            parts.append(f"<p><b>{text(name)}</b></p>")
        parts.append(table(("part", "value", "", "source"), _value_rows(values), "parameters"))
    return "".join(parts) + "<p class='soft'>* changed by the scenario</p></section>\n"


def _value_rows(found: list[Value]) -> list[tuple[str, ...]]:
    rows = []
    for part, values in groupby(found, key=lambda value: value.name.partition(".")[0]):
        for i, value in enumerate(values):
            words = text(value.name.partition(".")[2].replace("_", " "))
            mark = ("<b>*</b> " if value.changed else "") + ("" if value.fitted else "(not fitted) ")
            first = f"<b>{text(part.replace('_', ' '))}</b>" if i == 0 else ""
            rows.append((first, words, mark + text(value.value), text(value.source)))
    return rows


def scenarios(runs: list[Run], names: list[str]) -> str:
    """All that the scenarios say apart from the rig."""
    parts = ["<section id='scenario'><h2>Scenario</h2><p class='soft'>In SI units.</p>"]
    for run, name in zip(runs, names, strict=True):
        heads = (text(name) if len(runs) > 1 else "entry", "value")
        parts.append(table(heads, [(text(k), text(v)) for k, v in scenario_rows(run)], "numbers"))
    return "".join(parts) + "</section>\n"


def origin(runs: list[Run], names: list[str]) -> str:
    """Where each run comes from: file, identity, versions, host."""
    rows = []
    for run, name in zip(runs, names, strict=True):
        about = run.recording.metadata.get("run", {})
        facts = {"file": run.recording.path.name, "run": about.get("run_id", "-"), "recorded": about.get("recorded")}
        facts |= {"mode": about.get("mode"), **about.get("versions", {}), **about.get("host", {})}
        words = ", ".join(f"{key} {value}" for key, value in facts.items() if value)
        messages = sum(run.recording.counts.values())
        recording = run.recording
        whole = "" if recording.complete else ", CUT OFF" if recording.damage.cut else ", DAMAGED"
        rows.append((text(name), text(f"{words}, {messages} messages{whole}")))
    return f"<footer id='origin'><h2>Origin</h2>{table(('run', ''), rows)}</footer>\n"
