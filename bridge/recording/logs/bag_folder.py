"""Which files of a folder are those of one bag of ROS 2: what metadata.yaml lists, else NAME_0, NAME_1, ..."""

import re
from pathlib import Path

from bridge.errors import UsageError

ENDINGS = (".mcap", ".db3")
METADATA = "metadata.yaml"
LISTED = re.compile(r"^\s*-\s+['\"]?([^'\"\n]+?)['\"]?\s*$", re.MULTILINE)  # an entry of a list, one on each line
PART = re.compile(r"^(.*)_\d+$")  # of a bag, as rosbag2 names them
LONGEST = 1 << 20  # bytes of metadata.yaml that are looked at


def files_of_bag(folder: Path) -> list[Path]:
    """The files of the one bag in a folder. Raises UsageError for a folder without a bag, or with other files."""
    files = sorted(file for file in folder.iterdir() if file.suffix in ENDINGS)
    if not files:
        packed = any(file.suffix == ".zstd" for file in folder.iterdir())
        how = "its files are packed: unpack them with zstd -d" if packed else "a rosbag2 folder holds .mcap or .db3"
        raise UsageError(f"{folder}: is a folder without a bag; {how}")
    if listed := _listed(folder):
        return [file for file in files if file.name in listed] or files
    names = {match[1] if (match := PART.match(file.stem)) else file.stem for file in files}
    if len(names) > 1:
        raise UsageError(
            f"{folder}: is a folder with {len(files)} files ({files[0].name}, {files[1].name}, ...) and without the "
            f"{METADATA} of a rosbag2: name one of its files"
        )
    return files


def _listed(folder: Path) -> set[str]:
    """Names in the lists of metadata.yaml, those of the bag's files among them; empty without such a file."""
    path = folder / METADATA
    if not path.is_file():
        return set()
    with path.open(encoding="utf-8", errors="replace") as file:
        return {match[1] for match in LISTED.finditer(file.read(LONGEST))} | {METADATA}
