"""The page of a campaign: one HTML file, readable offline: what failed, worst first, each with its run's picture."""

from collections.abc import Iterator
from pathlib import Path

from bridge.drawing.html import table, text
from bridge.errors import writing
from bridge.report.campaign_margins import margins
from bridge.report.page import CSS
from bridge.runs.campaign.campaign import Failure, Found, Judged
from bridge.runs.campaign.statistics import CONFIDENCE, QUANTILES
from bridge.runs.campaign.table import bands_of, cells_of, name_of, quantile_words, settings_of

MOST_ROWS = 200  # of one table; the rest are in the CSV
OWN_CSS = """
.matrix td:not(:first-child) { text-align: center } .matrix th:not(:first-child) { text-align: center }
.all { background: #dcefe1 } .some { background: #fdeccb } .nothing { background: #f6d5d3 }
h3 { font-size: .95rem; margin: 1.4rem 0 .2rem; break-after: avoid }
"""


def write_page(found: Found, path: Path) -> Path:
    """Write the page."""
    with writing(path):
        path.write_text(page(found), encoding="utf-8")
    return path


def page(found: Found) -> str:
    """The whole page."""
    title = text(found.matrix.file.title)
    body = [_head(found), _matrix(found), _failures(found), _shrunk(found), _bands(found), _statistics(found)]
    body += [margins(found), _failed(found)]
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{CSS}{OWN_CSS}</style></head>\n<body>\n{''.join(body)}\n</body></html>\n"
    )


def _section(name: str, title: str, *parts: str) -> str:
    return f"<section id='{name}'><h2>{text(title)}</h2>{''.join(parts)}</section>\n"


def _head(found: Found) -> str:
    file, failed = found.matrix.file, len(found.runs) - found.passed
    badge = "good" if found.accepted else "bad"
    words = f"{found.passed} of {len(found.runs)} runs keep all their bands"
    asked = "" if file.accept == 1.0 else f" At least {file.accept:.1%} are asked for."
    kinds = f" The {failed} that do not fail in {len(found.failures)} ways." if failed else ""
    return (
        f"<header><h1>{text(file.title)}</h1><p class='lead'>{words}.{asked}{kinds} "
        f"<span class='badge {badge}'>{'accepted' if found.accepted else 'not accepted'}</span></p></header>\n"
    )


def _matrix(found: Found) -> str:
    """Faults by scenarios."""
    rows = []
    for fault in found.matrix.file.faults:
        cells = [f"<b>{text(fault.name)}</b> {text(fault.title)}"]
        for scenario in found.matrix.scenarios:
            own = [one.passed for one in found.runs if (one.run.scenario, one.run.fault) == (scenario, fault.name)]
            kind = "all" if all(own) else "some" if any(own) else "nothing"
            cells.append(
                f'<span class="badge none {kind}" style="color:#1c2430">{sum(own)} of {len(own)}</span>' if own else "-"
            )
        rows.append(cells)
    heads = ["fault", *map(text, found.matrix.scenarios)]
    return _section("matrix", "Runs that keep all bands", table(heads, rows, "matrix"))


def _failures(found: Found) -> str:
    if not found.failures:
        return ""
    parts = [_failure(found, failure) for failure in found.failures[: found.matrix.file.pictures or MOST_ROWS]]
    left = len(found.failures) - len(parts)
    more = f"<p class='soft'>{left} more ways are in the table of failed runs.</p>" if left else ""
    words = "Runs of one scenario and fault that break the same band most are shown by the worst of them."
    return _section("failures", "What failed, worst first", f"<p class='soft'>{words}</p>", *parts, more)


def _failure(found: Found, failure: Failure) -> str:
    one = failure.worst
    bands = [
        (text(f"{b['id']}: {b['band']}" if b["id"] else b["band"]), text(b["found"]), _mark(b["passed"]))
        for b in one.result["bands"]
    ]
    reason = f"<p class='failed'>{text(one.result['reason'])}</p>" if one.result["reason"] else ""
    picture = found.pictures.get(one.run.number, "")
    drawn = f"<figure>{picture}<figcaption>{_caption(found, one)}</figcaption></figure>" if picture else ""
    title = f"{one.run.scenario}, {one.run.fault}: {len(failure.runs)} of {failure.of} runs"
    shown = table(("expected", "found", ""), bands, "bands") if bands else ""
    return f"<h3 id='run{one.run.number}'>{text(title)}</h3>{reason}{shown}{drawn}"


def _caption(found: Found, one: Judged) -> str:
    return text(f"Run {one.run.number}: {name_of(found, one.run)}. Dotted: what the timeline changes.")


def _mark(passed: bool) -> str:
    return f'<span class="{"passed" if passed else "failed"}">{"passed" if passed else "FAILED"}</span>'


def _shrunk(found: Found) -> str:
    if not found.shrunk:
        return ""
    rows = [
        (text(one.wish.words), text(", ".join((one.scenario, *filter(None, one.parameters)))), text(one.words))
        for one in found.shrunk
    ]
    note = "By bisection; where a fault breaks a band, lets go and breaks it again, other edges lie between."
    return _section(
        "shrunk",
        "The smallest fault that breaks a band",
        table(("number", "runs", "edge"), rows),
        f"<p class='soft'>{note}</p>",
    )


def _bands(found: Found) -> str:
    """Each band, and how often it is kept."""
    rows = []
    for column in bands_of(found):
        own = [(b, one) for one in found.runs for b in one.result["bands"] if (b["band"], b["id"]) == column[:2]]
        kept = sum(band["passed"] for band, _ in own)
        worst = max(own, key=lambda pair: pair[0]["excess"])
        seen = f"{text(worst[0]['found'])} in run {worst[1].run.number}" if not worst[0]["passed"] else ""
        rows.append((text(column.id or "-"), text(column.band), text(column.text), f"{kept} of {len(own)}", seen))
    heads = ("requirement", "band", "in words", "kept", "worst")
    return _section("bands", "Requirements", table(heads, rows, "bands"))


def _statistics(found: Found) -> str:
    cells, matrix = cells_of(found), found.matrix
    if all(cell.share.runs < 2 for cell in cells):
        return ""
    heads = ["scenario", "fault", *(a.name for a in matrix.parameters), "passed", *(m.label for m in matrix.measures)]
    rows = []
    for cell in cells[:MOST_ROWS]:
        pairs = zip(cell.quantiles, matrix.measures, strict=True)
        shown = ["<br>".join(text(quantile_words(q, m)) for q in own or []) or "-" for own, m in pairs]
        own = (cell.scenario, cell.fault, *cell.parameters)
        rows.append([*map(text, own), text(f"{cell.share.passed} of {cell.share.runs}, {cell.share.words}"), *shown])
    names = ", ".join(f"{share:.0%}" for share in QUANTILES)
    note = (
        f"In brackets intervals of {CONFIDENCE:.0%}: of the share Wilson's, of the quantiles ({names} of the runs lie "
        "below) between order statistics, which hold for any distribution; - where there are too few runs for an end. "
        f"{_drawn(found)}"
    )
    return _section(
        "statistics",
        "Shares and metrics",
        table(list(map(text, heads)), rows, "numbers"),
        f"<p class='soft'>{text(note)}</p>",
    )


def _drawn(found: Found) -> str:
    file = found.matrix.file
    words = [f"{d.label} {d.kind} {', '.join(f'{n:g}' for n in d.numbers)}" for d in file.draws]
    return f"Drawn {file.drawn} times with seed {file.draw_seed}: {'; '.join(words)}." if words else ""


def _failed(found: Found) -> str:
    """All runs that failed, in the order of the matrix."""
    failed = [one for one in found.runs if not one.passed]
    if not failed:
        return ""
    rows = list(_failed_rows(found, failed[:MOST_ROWS]))
    left = len(failed) - len(rows)
    more = f"<p class='soft'>{left} more are in campaign.csv.</p>" if left else ""
    heads = ("run", "scenario", "fault", "numbers", "seed", "not kept")
    return _section("failed", "All failed runs", table(heads, rows), more)


def _failed_rows(found: Found, failed: list[Judged]) -> Iterator[list[str]]:
    for one in failed:
        numbers = ", ".join(f"{name} = {value}" for name, value in settings_of(found, one.run))
        own = (str(one.run.number), one.run.scenario, one.run.fault, numbers, str(one.run.seed), "; ".join(one.broken))
        yield [text(cell) for cell in own]
