"""The PR2 of the package `example-robot-data`: found, patched, and cached on disk.

The shipped model loads, but differs from the robot. Six patches correct it; each states the problem that it removes:

1. Links without `<inertial>` get mass 1e-4: PyBullet gives each 1 kg, 4 kg on the right arm alone.
2. Facet normals of the meshes are recomputed: nine arm and gripper meshes ship zero normals and render black.
3. Every visual is neutral grey: debug colours make the robot look like a coloured object.
4. `<gazebo>`, `<transmission>` and marker boxes are dropped, and mesh paths made relative to the patched file.
5. A planar base (`base_x`, `base_y`, `base_theta`) stands between the world and `base_footprint`.
6. The Kinect's frames are added on the head plate, with their nominal offsets.
"""

import contextlib
import ctypes
import hashlib
import importlib.metadata
import os
import shutil
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

from skolem.traces.errors import InternalError

PATCH_VERSION = 1
_DISTRIBUTION = "example-robot-data"
_URDF, _SRDF, _MESHES = "urdf/pr2.urdf", "srdf/pr2.srdf", "meshes"
_MARKER_SIZE_M = 0.011  # boxes up to this size are debug markers
_BASE_RANGE_M = 20.0
_FACET = np.dtype([("normal", "<f4", 3), ("vertices", "<f4", (3, 3)), ("attribute", "<u2")])
_STL_HEADER = 84
_LIGHT, _DARK, _GREY = ".92 .92 .90 1", ".35 .35 .38 1", ".75 .75 .78 1"
_LIGHT_PARTS = ("base", "torso", "shoulder", "upper_arm", "head")
_DARK_PARTS = ("finger", "caster", "wheel", "stereo", "laser")
_KINECT_JOINTS = (  # child, parent, xyz, rpy: nominal mount of a Kinect v1 on the PR2's head plate
    ("head_mount_link", "head_plate_frame", "-0.138 0 0.091", "0 0 0"),
    ("head_mount_kinect_ir_link", "head_mount_link", "-0.032267 0.0125 0.136453", "0 0 0"),
    ("head_mount_kinect_optical_frame", "head_mount_kinect_ir_link", "0 0.01 0", "-1.57079632679 0 -1.57079632679"),
)


@contextlib.contextmanager
def quiet_output() -> Iterator[None]:
    """Discard the output of C code on the standard streams: PyBullet prints a banner there."""
    c_library = ctypes.CDLL(None if os.name == "posix" else "ucrtbase")  # its buffers outlive the redirection
    sys.stdout.flush()
    sys.stderr.flush()
    c_library.fflush(None)
    saved = os.dup(1), os.dup(2)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        c_library.fflush(None)
        for descriptor, copy in zip((1, 2), saved, strict=True):
            os.dup2(copy, descriptor)
            os.close(copy)


@cache
def model_folder() -> Path:
    """Return the installed folder `pr2_description` of the robot's package.

    Raises:
        InternalError: If the package is installed without its PR2.
    """
    distribution = importlib.metadata.distribution(_DISTRIBUTION)
    for file in distribution.files or ():
        if file.as_posix().endswith("robots/pr2_description/" + _URDF):
            return Path(str(distribution.locate_file(file))).parents[1]
    raise InternalError(f"package {_DISTRIBUTION} {distribution.version} holds no pr2_description/{_URDF}")


def srdf_path() -> Path:
    """Return the path of the file that lists the link pairs without collision check."""
    return model_folder() / _SRDF


@cache
def robot_sha256() -> str:
    """Return the hash of URDF, SRDF, the meshes they name and the patch version: the identity of the robot."""
    digest = hashlib.sha256(f"patch {PATCH_VERSION}".encode())
    for name in (_URDF, _SRDF, *_mesh_names(ET.parse(model_folder() / _URDF).getroot())):
        data = (model_folder() / name).read_bytes()
        digest.update(f"\n{name} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def patched_urdf_path() -> Path:
    """Return the path of the patched model in the user's cache, which is made on first use.

    Two processes may make it at once.
    """
    folder = _cache_folder() / f"pr2-{robot_sha256()[:16]}"
    if not folder.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=folder.name + "-", dir=folder.parent))
        _write_model(draft)
        try:
            draft.rename(folder)
        except OSError:  # another process was faster; its files are the same
            shutil.rmtree(draft)
    return folder / "pr2.urdf"


def patched_urdf() -> str:
    """Return the text of the patched model; its mesh paths are relative to the file."""
    root = ET.parse(model_folder() / _URDF).getroot()
    _drop_noise(root)
    for mesh in root.iter("mesh"):
        mesh.set("filename", _mesh_name(mesh))
    for link in root.findall("link"):
        if link.find("inertial") is None:
            _add_inertial(link)
        _paint(link)
    _add_planar_base(root)
    for child, parent, xyz, rpy in _KINECT_JOINTS:
        _add_inertial(ET.SubElement(root, "link", name=child))
        _add_joint(root, child.removesuffix("_link") + "_joint", "fixed", (parent, child), xyz, rpy)
    return ET.tostring(root, encoding="unicode")


def _cache_folder() -> Path:
    """Return the folder of this user's caches of the product."""
    home = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(home) if home else Path.home() / ".cache") / "skolem"


def _mesh_name(mesh: ET.Element) -> str:
    """Return a mesh's path inside the model folder."""
    return _MESHES + "/" + mesh.get("filename", "").split("pr2_description/meshes/")[1]


def _mesh_names(root: ET.Element) -> list[str]:
    """Return the paths of all meshes that the model names, sorted."""
    return sorted({_mesh_name(mesh) for mesh in root.iter("mesh")})


def _write_model(folder: Path) -> None:
    """Write the patched model and its repaired meshes into `folder`."""
    for name in _mesh_names(ET.parse(model_folder() / _URDF).getroot()):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(_with_normals((model_folder() / name).read_bytes()))
    (folder / "pr2.urdf").write_text(patched_urdf(), encoding="utf-8")


def _with_normals(stl: bytes) -> bytes:
    """Return a binary STL with every facet normal computed from its vertices."""
    count = int.from_bytes(stl[_STL_HEADER - 4 : _STL_HEADER], "little")
    facets = np.frombuffer(stl, _FACET, count, _STL_HEADER).copy()
    corner = facets["vertices"].astype(np.float64)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.maximum(np.linalg.norm(normal, axis=1), np.finfo(np.float64).tiny)
    facets["normal"] = (normal / length[:, None]).astype("<f4")
    return stl[:_STL_HEADER] + facets.tobytes()


def _drop_noise(root: ET.Element) -> None:
    """Remove elements that are no part of the robot's body: simulator plug-ins, transmissions, marker boxes."""
    for child in list(root):
        if child.tag not in ("link", "joint", "material"):
            root.remove(child)
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            box = visual.find("geometry/box")
            if box is not None and max(map(float, box.get("size", "").split())) <= _MARKER_SIZE_M:
                link.remove(visual)


def _paint(link: ET.Element) -> None:
    """Give every visual of a link one of three greys, by the part of the body."""
    name = link.get("name", "")
    light, dark = any(part in name for part in _LIGHT_PARTS), any(part in name for part in _DARK_PARTS)
    rgba = _LIGHT if light else _DARK if dark else _GREY
    for visual in link.findall("visual"):
        for material in visual.findall("material"):
            visual.remove(material)
        ET.SubElement(ET.SubElement(visual, "material", name="grey_" + name), "color", rgba=rgba)


def _add_inertial(link: ET.Element) -> None:
    """Give a link without inertia a negligible mass."""
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", value="1e-4")
    ET.SubElement(inertial, "inertia", ixx="1e-7", iyy="1e-7", izz="1e-7", ixy="0", ixz="0", iyz="0")


def _add_joint(
    root: ET.Element, name: str, kind: str, links: tuple[str, str], xyz: str = "0 0 0", rpy: str = "0 0 0"
) -> ET.Element:
    """Add a joint from the first link to the second and return it."""
    joint = ET.SubElement(root, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=links[0])
    ET.SubElement(joint, "child", link=links[1])
    ET.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
    return joint


def _add_planar_base(root: ET.Element) -> None:
    """Put two prismatic joints and a continuous one below `base_footprint`."""
    for name in ("world_link", "base_x_link", "base_y_link"):
        _add_inertial(ET.SubElement(root, "link", name=name))
    chain = (
        ("base_x", "prismatic", ("world_link", "base_x_link"), "1 0 0"),
        ("base_y", "prismatic", ("base_x_link", "base_y_link"), "0 1 0"),
        ("base_theta", "continuous", ("base_y_link", "base_footprint"), "0 0 1"),
    )
    for name, kind, links, axis in chain:
        joint = _add_joint(root, name, kind, links)
        ET.SubElement(joint, "axis", xyz=axis)
        if kind == "prismatic":
            limit = {"lower": str(-_BASE_RANGE_M), "upper": str(_BASE_RANGE_M), "effort": "10000", "velocity": "1"}
            ET.SubElement(joint, "limit", limit)
