"""Damaged logs: whatever bytes are wrong, a log is read or refused in one sentence, never with a traceback."""

import gzip
import json
import random
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.writer import Writer
from scipy.io import savemat

from bridge.errors import UsageError
from bridge.recording.logs.guess import guessed_map
from tests.support.logs import BAR, MM, ROWS, TIME, VOLTS, made_of

TRIES = 15  # of each form
SECONDS = '[time]\ncolumn = "t"\nunit = "s"'
ODD = (b"\x00", b"\xff", b'"', b";", b",", b"\n", b"nan", b"1e999", b"-", b"\r", b"[", b"\xef\xbb\xbf", b"9" * 400)


def text() -> bytes:
    rows = zip(TIME, VOLTS, MM, BAR, strict=True)
    return ("t,u,x,p\n" + "".join(f"{t:.3f},{u:.3f},{x:.3f},{p:.3f}\n" for t, u, x, p in rows)).encode()


def csv(path: Path) -> None:
    path.write_bytes(text())


def packed(path: Path) -> None:
    path.write_bytes(gzip.compress(text()))


def mat(path: Path) -> None:
    savemat(path, {"t": TIME, "u": VOLTS, "x": MM, "p": BAR, "s": {"a": MM}}, do_compression=False)


def hdf(path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name, values in (("t", TIME), ("u", VOLTS), ("x", MM), ("p", BAR)):
            file[name] = values


def parquet(path: Path) -> None:
    pyarrow, writer = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    writer.write_table(pyarrow.table({"t": TIME, "u": VOLTS, "x": MM, "p": BAR}), path)


def mdf(path: Path) -> None:
    asammdf = pytest.importorskip("asammdf")
    file = asammdf.MDF(version="4.10")
    signals = (("u", VOLTS), ("x", MM), ("p", BAR))
    file.append([asammdf.Signal(values, TIME, name=name) for name, values in signals])
    file.save(path)
    file.close()


def bag(path: Path) -> None:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("r", "json", writer.register_schema("r", "jsonschema", b"{}"))
        for k in range(ROWS):
            body = {"t": float(TIME[k]), "u": float(VOLTS[k]), "x": MM[k], "p": BAR[k]}
            writer.add_message(channel, k * 10**6, json.dumps(body).encode(), k * 10**6, k)
        writer.finish()


FORMS = {"csv": csv, "csv.gz": packed, "mat": mat, "h5": hdf, "parquet": parquet, "mf4": mdf, "mcap": bag}


def damaged(content: bytes, chance: random.Random) -> bytes:
    """A piece overwritten, cut out, doubled or put in; more of the damage is near the beginning, where heads are."""
    found = bytearray(content)
    for _ in range(chance.randint(1, 6)):
        near = chance.random() < 0.6
        at = chance.randrange(min(len(found), 400) if near else len(found)) if found else 0
        kind, length = chance.randrange(5), chance.choice((1, 1, 2, 8, 40))
        if kind == 0:
            found[at : at + length] = chance.randbytes(length)
        elif kind == 1:
            del found[at : at + length]
        elif kind == 2:
            found[at:at] = found[at : at + 30 * length]
        elif kind == 3:
            found[at:at] = chance.choice(ODD)
        else:
            del found[at + 200 * length :]
    return bytes(found)


def words_of(call: Callable[[], object]) -> str:
    """What a call refuses; empty where it does not."""
    try:
        call()
    except UsageError as error:
        return str(error)
    return ""


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("form", FORMS)
def test_damage_is_read_or_refused(form: str, tmp_path: Path):
    FORMS[form](tmp_path / f"whole.{form}")
    whole, chance = (tmp_path / f"whole.{form}").read_bytes(), random.Random(form)
    prefix, time = ("r.", '[time]\ncolumn = "r.t"\nunit = "s"') if form == "mcap" else ("", SECONDS)
    time, path, said = "" if form == "mf4" else time, tmp_path / f"log.{form}", []
    for _ in range(TRIES):
        path.write_bytes(damaged(whole, chance))
        said.append(words_of(lambda: made_of(path, f"{prefix}u", f"{prefix}x", f"{prefix}p", time)))
        words_of(lambda: guessed_map(path, "ehla"))
    assert any(said)
    assert not any("\n" in words for words in said)
