import hashlib
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from skolem.sim.robot import assets


@pytest.fixture(scope="module")
def model() -> ET.Element:
    return ET.fromstring(assets.patched_urdf())


def test_every_link_has_a_mass_of_its_own(model: ET.Element) -> None:
    assert [link.get("name") for link in model.findall("link") if link.find("inertial/mass") is None] == []


def test_the_robot_is_grey(model: ET.Element) -> None:
    colours = [colour.get("rgba", "").split() for colour in model.findall("link/visual/material/color")]
    assert len(colours) == len(model.findall("link/visual"))
    assert max(max(map(float, rgb[:3])) - min(map(float, rgb[:3])) for rgb in colours) < 0.05


def test_nothing_but_links_and_joints_is_left(model: ET.Element) -> None:
    assert {child.tag for child in model} <= {"link", "joint", "material"}


def test_base_joints_and_kinect_frames_are_added(model: ET.Element) -> None:
    joints = {joint.get("name"): joint.get("type") for joint in model.findall("joint")}
    assert [joints[name] for name in ("base_x", "base_y", "base_theta")] == ["prismatic", "prismatic", "continuous"]
    assert "head_mount_kinect_ir_link" in {link.get("name") for link in model.findall("link")}


def test_every_name_in_the_collision_list_is_a_link(model: ET.Element) -> None:
    links = {link.get("name") for link in model.findall("link")}
    pairs = ET.parse(assets.srdf_path()).getroot().findall("disable_collisions")
    assert len(pairs) > 100
    assert {pair.get(end) for pair in pairs for end in ("link1", "link2")} <= links


def test_the_patched_model_is_cached_whole_and_its_meshes_lie_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, model: ET.Element
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path = assets.patched_urdf_path()
    assert path.is_relative_to(tmp_path)
    assert path.read_text(encoding="utf-8") == assets.patched_urdf()
    names = {mesh.get("filename", "") for mesh in model.iter("mesh")}
    assert len(names) == 26
    assert all((path.parent / name).is_file() for name in names)
    assert [folder.name for folder in path.parent.parent.iterdir()] == [path.parent.name]


def test_a_second_look_makes_nothing_new(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first = assets.patched_urdf_path().stat().st_mtime_ns
    assert assets.patched_urdf_path().stat().st_mtime_ns == first


def test_the_identity_of_the_robot_is_a_hash_of_content() -> None:
    assert len(assets.robot_sha256()) == len(hashlib.sha256().hexdigest())
    assert assets.robot_sha256() == assets.robot_sha256.__wrapped__()


def test_importing_pybullet_says_nothing() -> None:
    code = "from skolem.sim.robot.bullet import p; print(p.DIRECT)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("2\n", "")


def test_python_output_around_the_silence_survives() -> None:
    code = "\n".join(
        [
            "from skolem.sim.robot.assets import quiet_output",
            "print('a', end='')",
            "with quiet_output():",
            "    pass",
            "print('b')",
        ]
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "ab\n"
