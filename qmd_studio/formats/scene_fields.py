"""What type a field has and where a node belongs, from the tables of X3D's nodes that ship (ISO/IEC 19775-1, 19776-1).

H-Anim's PROTOs of VRML97 are known by their names without the prefix, and their fields with those of today.
"""

from __future__ import annotations

from functools import lru_cache

from qmd_studio.formats.scene_graph import Scene
from qmd_studio.motion.hanim import table_rows

HANIM_PROTOS = {name: f"HAnim{name}" for name in ("Humanoid", "Joint", "Segment", "Site", "Displacer")}
"""The PROTO names of H-Anim 1.0 to 2001 in VRML97, and the nodes of X3D that they are."""

_MORE_TYPES = {"humanoidBody": "MFNode", "authorEmail": "SFString", "skeletalConfiguration": "SFString"}


def field_type(node_type: str, name: str) -> str | None:
    """Return the type of a node's field, such as "MFVec3f"; None where the tables know none."""
    usual, special = _types()
    found = special.get((HANIM_PROTOS.get(node_type, node_type), name))
    return found or usual.get(name)


def default_place(node_type: str, parent_type: str) -> str:
    """Return the field of the parent that a node is meant for where XML does not say (containerField)."""
    if node_type.startswith("Metadata"):
        return "value" if parent_type == "MetadataSet" else "metadata"
    if node_type == "HAnimMotion" and parent_type != "HAnimHumanoid":
        return "children"
    if parent_type in ("Scene", "ProtoBody"):
        return "children"
    return _places().get(node_type, "children")


def is_known(node_type: str) -> bool:
    """Tell whether X3D has a node of this type."""
    return node_type in _places()


def declared_types(scene: Scene) -> dict[tuple[str, str], str]:
    """Return the types of fields that the scene's PROTOs declare, by (PROTO, field)."""
    from qmd_studio.formats.scene_graph import Proto

    protos = [value for _, value in scene.root.fields if isinstance(value, Proto)]
    return {(proto.name, field.name): field.type for proto in protos for field in proto.interface}


@lru_cache(maxsize=1)
def _types() -> tuple[dict[str, str], dict[tuple[str, str], str]]:
    usual: dict[str, str] = dict(_MORE_TYPES)
    special: dict[tuple[str, str], str] = {}
    for row in table_rows("x3d_fields.csv"):
        if not row["nodes"]:
            usual[row["field"]] = row["type"]
        for node in row["nodes"].split():
            special[(node, row["field"])] = row["type"]
    return usual, special


@lru_cache(maxsize=1)
def _places() -> dict[str, str]:
    return {node: row["container"] for row in table_rows("x3d_nodes.csv") for node in row["nodes"].split()}
