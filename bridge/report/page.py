"""The report's page: one HTML file, readable offline, in a window and on paper."""

from collections.abc import Sequence
from pathlib import Path

from bridge.drawing.html import svg, text
from bridge.errors import UsageError, writing
from bridge.report.charts import CHARTS, draw_chart
from bridge.report.estimates import CAPTION as ESTIMATED
from bridge.report.estimates import draw_estimates, has_estimates, innovations_table
from bridge.report.health import caption_of, draw_health, has_health
from bridge.report.maps import draw_maps, draw_timing
from bridge.report.own_signals import draw_own, own_charts
from bridge.report.sections import (
    circuit,
    differences,
    events,
    head,
    metrics,
    origin,
    parameters,
    scenarios,
    timing_table,
)
from bridge.report.stability import CAPTION, draw_stability, stability_points, words
from bridge.report.subject import Run, load_run, named_apart

CSS = """
:root { --ink: #1c2430; --soft: #5c6675; --line: #d9dde3; --good: #2c7a43; --bad: #b3312c; --blue: #2a6fbb }
* { box-sizing: border-box }
body { font: 15px/1.5 "DejaVu Sans", Verdana, Arial, sans-serif; color: var(--ink); background: #fff;
  max-width: 62rem; margin: 2rem auto; padding: 0 1.5rem }
header { border-bottom: 3px solid var(--blue); padding-bottom: .8rem; margin-bottom: 1rem }
h1 { font-size: 1.55rem; line-height: 1.25; margin: .3rem 0 }
h2 { font-size: 1.1rem; margin: 2rem 0 .4rem; border-bottom: 1px solid var(--line); padding-bottom: .2rem }
p { margin: .3rem 0 .6rem } .lead { font-size: 1.02rem } .soft, figcaption { color: var(--soft); font-size: .85rem }
.badge { display: inline-block; color: #fff; border-radius: .3rem; padding: .05rem .6rem; font-size: .85rem }
.good { background: var(--good) } .bad { background: var(--bad) } .none { background: var(--soft) }
.passed { color: var(--good); font-weight: bold } .failed { color: var(--bad); font-weight: bold }
figure { margin: .6rem 0 0; break-inside: avoid } svg { display: block; height: auto }
table { border-collapse: collapse; width: 100%; font-size: .82rem; margin: .4rem 0 }
th { text-align: left; color: var(--soft); font-weight: normal; border-bottom: 1px solid var(--ink) }
td { border-bottom: 1px solid var(--line); vertical-align: top } th, td { padding: .22rem .8rem .22rem 0 }
tr { break-inside: avoid } .numbers td:not(:first-child) { font-variant-numeric: tabular-nums; white-space: nowrap }
.changed td { background: #fff6e0 } h2 { break-after: avoid } footer { margin-top: 2.5rem }
.key { display: inline-block; width: .8rem; height: .8rem; border-radius: .15rem; vertical-align: -.05rem }
@page { size: A4; margin: 14mm }
@media print { body { max-width: none; margin: 0; padding: 0; font-size: 9.5pt } h2 { margin-top: 1.2rem } }
"""


def write_report(files: Sequence[Path], output: Path) -> Path:
    """Write the report on one recording or several. Raises UsageError with one line."""
    runs = [load_run(path) for path in files]
    if output.suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"{output}: a report is an HTML page; name it {output.with_suffix('.html')}")
    with writing(output):
        output.write_text(page(runs), encoding="utf-8")
    return output


def page(runs: list[Run]) -> str:
    """The whole page."""
    names = named_apart(runs)
    title = text(runs[0].scenario.title or runs[0].scenario.name)
    body = [head(runs, names), metrics(runs, names)]
    body += [differences(runs, names)] if len(runs) > 1 else []
    body += [
        _charts(runs, names),
        _stability(runs, names),
        *_maps(runs, names),
        _timing(runs, names),
        events(runs, names),
    ]
    body += [circuit(runs, names), parameters(runs, names), scenarios(runs, names), origin(runs, names)]
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{CSS}</style></head>\n<body>\n{''.join(body)}\n</body></html>\n"
    )


def figure(drawn: object, name: str, title: str, caption: str) -> str:
    """A section with one picture."""
    picture = svg(drawn, name, title)
    return (
        f"<section id='{name}'><h2>{text(title)}</h2><figure>{picture}"
        f"<figcaption>{text(caption)}</figcaption></figure></section>\n"
    )


def _charts(runs: list[Run], names: list[str]) -> str:
    shown = [chart for chart in CHARTS if chart.filled(runs) and any(chart.shown(run) for run in runs)]
    drawn = [figure(draw_chart(chart, runs, names), chart.name, chart.title, chart.caption(runs)) for chart in shown]
    own = [
        figure(draw_own(chart, runs, names), f"signals{i}", chart.title, chart.kind.caption)
        for i, chart in enumerate(own_charts(runs), 1)
    ]
    followed = [
        figure(draw_estimates(run), f"estimate{i}", f"Estimate{f': {name}' if len(runs) > 1 else ''}", ESTIMATED)
        + innovations_table(run)
        for i, (run, name) in enumerate(zip(runs, names, strict=True), 1)
        if has_estimates(run)
    ]
    judged = [
        figure(draw_health(run), f"health{i}", f"Health{f': {name}' if len(runs) > 1 else ''}", caption_of(run))
        for i, (run, name) in enumerate(zip(runs, names, strict=True), 1)
        if has_health(run)
    ]
    return "".join(drawn + own + followed + judged)


def _stability(runs: list[Run], names: list[str]) -> str:
    points = stability_points(runs)
    drawn = draw_stability(runs, points)
    chart = "" if drawn is None else figure(drawn, "stability", "Gain and stability", CAPTION)
    return chart + words(runs, names, points)


def _maps(runs: list[Run], names: list[str]) -> list[str]:
    caption = "Each pipe from its first end, at the bottom, to its second. Violet is vapour."
    titles = ["Pressure over length and time" + (f": {name}" if len(runs) > 1 else "") for name in names]
    pairs = [(i, pair) for i, pair in enumerate(zip(runs, titles, strict=True), 1) if not pair[0].measured]
    return [figure(draw_maps(run), f"map{i}", title, caption) for i, (run, title) in pairs]


def _timing(runs: list[Run], names: list[str]) -> str:
    drawn = draw_timing(runs, names)
    if drawn is None:
        return ""
    caption = "How late each tick woke up, and how long a measurement took to come back as a command."
    return figure(drawn, "timing", "Timing", caption) + timing_table(runs, names)
