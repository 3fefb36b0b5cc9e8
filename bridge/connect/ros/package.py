"""The ament package `hydrotwin_msgs`, written from the table of messages: what colcon needs to build them."""

from pathlib import Path

from bridge.errors import UsageError, writing
from bridge.machine.host import versions
from bridge.wire.channels import Layout, text_of
from bridge.wire.messages import PACKAGE, TEXTS, VARYING

NAME = PACKAGE.partition("/")[0]
MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>{version}</version>
  <description>Messages of hydrotwin, a digital twin of a hydraulic drive</description>
  <maintainer email="hydrotwin@localhost">hydrotwin</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""
BUILD = """\
cmake_minimum_required(VERSION 3.8)
project({name})

find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)

rosidl_generate_interfaces(${{PROJECT_NAME}}
{messages}
)

ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""


def write_package(folder: Path, layout: Layout = ()) -> list[Path]:
    """Write the package into a folder; its files. Further channels have a message only where a scenario chooses some.

    Raises UsageError where another package is in its place.
    """
    root = folder / NAME
    if root.exists() and not (root / "package.xml").is_file():
        raise UsageError(f"{root}: is there already and not a package of ROS; name another folder")
    files = {root / name: text for name, text in package_files(layout).items()}
    for path, text in files.items():
        with writing(path):
            path.write_text(text, encoding="utf-8")
    return list(files)


def package_files(layout: Layout = ()) -> dict[str, str]:
    """The files of the package by their names in it."""
    texts = {kind: text for kind, text in TEXTS.items() if kind.startswith(PACKAGE) and kind != VARYING}
    texts |= {VARYING: text_of(layout)} if layout else {}
    messages = {f"msg/{kind.rpartition('/')[2]}.msg": text for kind, text in texts.items()}
    listed = "\n".join(f'  "{name}"' for name in messages)
    return {
        "package.xml": MANIFEST.format(name=NAME, version=versions()["hydrotwin"]),
        "CMakeLists.txt": BUILD.format(name=NAME, messages=listed),
        **messages,
    }
