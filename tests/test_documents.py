"""README and docs: links lead somewhere, every page is in the navigation, what stands in code blocks is true."""

import ast
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.main import get_command

import hydrotwin as ht
from bridge.cli.catalogue import VERBS
from bridge.cli.verbs import app
from bridge.recording.logs.map import parsed_map
from bridge.scenario import load, names
from tests.support.command import hydrotwin_here
from tests.tools.site.markdown import Block, anchors, blocks, links, parts
from tests.tools.site.sources import ROOT, is_outside, pages, place_of, target_of
from tests.tools.site.verbs import verb_pages

TEXTS = {source: (ROOT / source).read_text(encoding="utf-8") for source in pages()}
BLOCKS = [(source, block) for source, text in TEXTS.items() for block in blocks(text)]
COMMANDS: Any = get_command(app)
NAVIGATION = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]


def of(*languages: str) -> list[tuple[str, Block]]:
    return [(source, block) for source, block in BLOCKS if block.language in languages]


def test_every_link_leads_to_a_file_and_a_heading_that_are_there():
    lost = []
    for source, text in TEXTS.items():
        for address, line in links(text):
            if is_outside(address):
                continue
            try:
                file, anchor = target_of(source, address)
            except ValueError:
                lost.append(f"{source}:{line}: {address}")
                continue
            if anchor and anchor not in anchors(TEXTS[file]):
                lost.append(f"{source}:{line}: {address}: no such heading")
    assert not lost


def test_every_page_is_in_the_navigation_once():
    """A page that nobody can come to is not there; that of a verb is found by its folder."""
    found = sorted(leaves(NAVIGATION))
    assert [p for p in found if not p.startswith(("commands/", "reference/"))] == sorted(map(place_of, pages()))
    assert {"commands/"} == {p for p in found if p.startswith("commands/")}


def leaves(entry: Any) -> list[str]:
    """The pages of a part of the navigation."""
    if isinstance(entry, str):
        return [entry]
    return [page for part in (entry.values() if isinstance(entry, dict) else entry) for page in leaves(part)]


def test_every_verb_has_a_page_with_its_usage():
    made = verb_pages()
    for name, verb in VERBS.items():
        text = made[f"commands/{name}.md"]
        assert text.startswith(f"# `hydrotwin {name}`"), name
        assert f"$ hydrotwin {name} [OPTIONS]" in text, name
        assert verb.words.split(":")[0].split("`")[0] in text, name
        for listed in ("commands/SUMMARY.md", "commands/index.md"):
            assert f"[{name}]({name}.md)" in made[listed], name


def test_toml_of_the_pages_loads(tmp_path):
    """As a scenario, a piece over what its page extends, or a map of a log; campaigns are read in test_campaign.py."""
    write_what_lessons_save(tmp_path)
    for source, block in of("toml"):
        if source == "docs/campaigns.md":
            continue
        if "[signal." in block.text:
            parsed_map(block.text, source)
            continue
        path = tmp_path / "piece.toml"
        base = re.search(r'^extends = "[\w-]+"$', TEXTS[source], re.MULTILINE)
        under = base[0] if base else "" if "[reference]" in block.text else 'extends = "step"'
        path.write_text(block.text if block.text.startswith("extends") else f"{under}\n{block.text}")
        load(str(path))


def write_what_lessons_save(folder: Path) -> None:
    """The scenarios of the tutorial, each by the name under which it says to save it."""
    for source, block in of("toml"):
        if source.startswith("docs/tutorial/"):
            before = " ".join(TEXTS[source].splitlines()[: block.line - 2][-6:]).rstrip()
            name = re.findall(r"[^`]*`([\w-]+\.toml)`[^`]*:$", before)[0]
            (folder / name).write_text(block.text)


def test_python_of_the_pages_compiles():
    for source, block in of("python"):
        compile(block.text, f"{source}:{block.line}", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)


def test_commands_in_code_blocks_are_taken_by_their_verbs():
    """Verb, arguments, options and choices, of every line but none of them run."""
    refused = []
    for source, block in of("", "console", "sh", "yaml"):
        for line in block.text.replace("\\\n", " ").splitlines():
            for command in re.split(r" && |; ", line.replace("- run: ", "")):
                if command.lstrip(" $").startswith("hydrotwin "):
                    reason = refusal(re.sub(r" > \S+(?= *(#|$))", "", command.lstrip(" $")))
                    refused += [f"{source}:{block.line}: {command.strip()}: {reason}"] if reason else []
    assert not refused


def refusal(command: str) -> str:
    """Why the command line does not take a command; empty where it does. Nothing is run."""
    name, found = "hydrotwin", COMMANDS
    try:
        words = shlex.split(command, comments=True)[1:]
        while hasattr(found, "resolve_command"):
            name, found, words = found.resolve_command(None, words)
        scenario = found.make_context(name, list(words)).params.get("scenario")
    except Exception as error:  # of typer's own kinds, which differ from version to version
        return str(error)
    unknown = isinstance(scenario, str) and not scenario.endswith(".toml") and scenario not in names()
    return f"there is no scenario {scenario}" if unknown else ""


GUIDES_OF_LOGS = {"docs/import.md": "## The foreign rig", "docs/identify.md": "## From a log"}


def commands_of(source: str, title: str) -> list[list[str]]:
    """The commands in the section of a page, as words behind `hydrotwin`."""
    section = TEXTS[source].partition(title)[2].partition("\n## ")[0]
    lines = section.replace("\\\n", " ").splitlines()
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("    hydrotwin ")]


def test_the_guides_of_logs_name_files_that_are_there_or_made_before():
    """Every command of the two sections can be given in a fresh checkout, in their order, and none undoes another."""
    made: dict[str, str] = {"nominal-into-plant.mcap": "docs/import.md"}  # by the replay, which names it itself
    for source, title in GUIDES_OF_LOGS.items():
        assert commands_of(source, title)
        for words in commands_of(source, title):
            written = {words[at + 1] for at, word in enumerate(words) if word in ("-o", "--report")}
            for word in {word for word in words if re.fullmatch(r"[\w./-]+\.(gz|toml|mcap)", word)} - written:
                assert word in made or (ROOT / word).is_file(), f"{source}: {word}"
            assert all(made.get(name, source) == source or name == "nominal.mcap" for name in written)
            made |= dict.fromkeys(written, source)


@pytest.mark.endurance
@pytest.mark.timeout(1200)
def test_the_guides_of_logs_go_as_they_say(tmp_path):
    """Their commands, and what they print: the numbers that the text names, to the digits that it has."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    printed = {}
    for source, title in GUIDES_OF_LOGS.items():
        for words in commands_of(source, title):
            done = hydrotwin_here(*words, cwd=tmp_path)
            assert done.returncode == 0, done.stderr
            printed[f"{source} {words[0]} {words[1]}"] = done.stdout
    assert re.search(r"measurement.position +\S+ mm +\S+ s +0\.64\d mm", printed["docs/import.md replay nominal.mcap"])
    nominal, later = (printed[f"docs/identify.md identify {name}.mcap"] for name in ("nominal", "later"))
    for text in ("199.6 kg .. 200.7 kg", "0.12%", "2.01", "1.52"):
        assert text in nominal, nominal
    for text in ("leakage_resistance explains most: alone it leaves 1.12", "83.26 bar/(l/min) .. 83.35 bar/(l/min)"):
        assert text in later, later


def test_commands_within_the_text_have_verbs_and_options_that_are_there():
    unknown = []
    for source, text in TEXTS.items():
        prose_of = " ".join(line.strip() for code, line in parts(text) if not code)
        for span in re.findall(r"`hydrotwin ([a-z][^`]*)`", prose_of) if source != "CHANGELOG.md" else []:
            verb, *words = span.split()
            known = options(COMMANDS.commands[verb]) if verb in VERBS else set()
            wrong = [word for word in words if word.startswith("--") and word.rstrip(",.") not in known]
            unknown += [f"{source}: hydrotwin {span}: {wrong or 'no such verb'}"] if wrong or verb not in VERBS else []
    assert not unknown


def options(command: Any) -> set[str]:
    """All options of a verb, of a group those of all its commands."""
    own = {name for param in command.params for name in (*param.opts, *param.secondary_opts)} | {"--help"}
    return own.union(*(options(each) for each in getattr(command, "commands", {}).values()))


def test_the_tutorial_goes_as_it_says(tmp_path, monkeypatch):
    """Its law fails the first band by what is printed, the second one passes it, and so does the bad day."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    lesson = [b.text for source, b in of("python") if source == "docs/tutorial/own-controller.md"]
    write_what_lessons_save(tmp_path)
    for name, law, found in (("first.py", lesson[0], "3.118 mm"), ("my_law.py", lesson[1], "0.6306 mm")):
        (tmp_path / name).write_text(law)
        assert found in TEXTS["docs/tutorial/own-controller.md"]
        assert ht.run("own.toml", changes={"controller.law": f"{name}:law"}).bands[0].found == found
    bad = ht.run("bad-day.toml")
    assert bad.passed
    assert all(band.found in TEXTS["docs/tutorial/ci.md"] for band in bad.bands)
