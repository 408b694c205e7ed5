"""Reading glTF 2.0: the first skinned figure of a file as a body, and its first animation as a motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.formats.gltf_animation import USUAL_FPS, Track, frame_times, guessed_fps, sampled, tracks_of
from qmd_studio.formats.gltf_document import Document, item, listed, name_of, open_document
from qmd_studio.formats.gltf_figure import Figure, check_length, figure_of, moving_joints, posed, skeleton_of, values_of
from qmd_studio.formats.gltf_mesh import Parts, parts_of, surface_of
from qmd_studio.formats.gltf_nodes import SCALE_MATTERS, own_extras, tree_of
from qmd_studio.formats.length_unit import stature
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.motion.motion import FRAME_RATES, Motion
from qmd_studio.motion.skeleton import ColumnKind, Skeleton

_PLAUSIBLE_M = (0.3, 3.0)


def read(data: bytes, options: ReadOptions) -> Loaded:
    """Read the figure of a .glb or .gltf file: its body where it has meshes, and its motion or the pose it stands in.

    The animation is sampled `options.fps` times a second, else as often as its keys come. Raises `FormatError`.
    """
    document = open_document(data, options.path)
    unit = options.metres_per_unit or 1.0
    tracks = tracks_of(document)
    tree = tree_of(document, {track.node for track in tracks if track.path != "weights"})
    figure = figure_of(document, tree, unit)
    parts = parts_of(document, figure)
    fps = _rate(document, tracks, options)
    times = frame_times(tracks, fps) if tracks else np.zeros(1)
    check_length(document, tree, len(times))
    turns, offsets = posed(figure, tracks, times, unit)
    driven = [(track, k) for track in tracks if track.path == "weights" for k in parts.driven.get(track.node, [])]
    opaque = [(parts.displacers[k].name, parts.displacers[k].joint) for _, k in driven]
    name = _name(document, figure)
    skeleton = skeleton_of(document, figure, moving_joints(figure, offsets), opaque=opaque, name=name)
    X = values_of(skeleton, turns, offsets)
    _set_weights(skeleton, X, parts, driven, times)
    motion = Motion(skeleton, X, fps, name=options.path.stem if options.path else "")
    if any(track.path == "scale" and np.ptp(track.values, axis=0).max() > SCALE_MATTERS for track in tracks):
        document.note("scales that change with time are shown by where they put the joints, not on the skin")
    _note_height(document, skeleton)
    body = _body(document, figure, skeleton, parts)
    return Loaded(skeleton, motion, body, tuple(document.warnings), tuple(document.notes))


def _rate(document: Document, tracks: list[Track], options: ReadOptions) -> float:
    if options.fps is not None:
        return options.fps
    own = own_extras(document).get("fps")
    if isinstance(own, int | float) and not isinstance(own, bool) and FRAME_RATES[0] <= own <= FRAME_RATES[1]:
        return float(own)
    return guessed_fps(tracks) if tracks else USUAL_FPS


def _set_weights(
    skeleton: Skeleton, X: FloatArray, parts: Parts, driven: list[tuple[Track, int]], times: FloatArray
) -> None:
    """Fill the opaque columns, one a driven displacer, from the tracks of weights."""
    first = skeleton.n_columns - len(driven)
    for place, (track, displacer) in enumerate(driven):
        weights = sampled(track, times)
        k = parts.driven[track.node].index(displacer)
        X[:, first + place] = weights[:, k] if k < weights.shape[1] else parts.displacers[displacer].weight


def _body(document: Document, figure: Figure, skeleton: Skeleton, parts: Parts) -> Body | None:
    surface = surface_of(parts)
    if surface is None:
        return None
    segments = own_extras(document).get("segments")
    good = isinstance(segments, list) and len(segments) == len(skeleton.joints)
    names = tuple(str(name)[:200] for name in segments) if good and isinstance(segments, list) else ()
    opaque = [c.name for c in skeleton.columns if c.kind is ColumnKind.OPAQUE]
    displacers = list(parts.displacers)
    if len(opaque) == len(displacers):  # a column that had to be named apart drives its displacer by that name
        displacers = [replace(d, name=name) for d, name in zip(displacers, opaque, strict=True)]
    return Body(skeleton.name, skeleton, surface, figure.bind, names, tuple(displacers))


def _name(document: Document, figure: Figure) -> str:
    own = own_extras(document).get("name")
    if isinstance(own, str):
        return own[:200]
    otherwise = name_of(figure.tree.entries[figure.tree.joints[0]], "figure")
    if figure.tree.skin is None or not listed(document.root, "skins"):
        return otherwise
    return name_of(item(document, "skins", figure.tree.skin), otherwise)


def _note_height(document: Document, skeleton: Skeleton) -> None:
    for text in own_extras(document).get("notes", []) or []:
        if isinstance(text, str) and len(document.notes) < 20:
            document.note(text[:300])
    height = stature(skeleton)
    if not _PLAUSIBLE_M[0] <= height <= _PLAUSIBLE_M[1]:
        document.note(
            f"the figure is {height:.2f} m tall in the file's metres; set the length unit if that is not meant"
        )
