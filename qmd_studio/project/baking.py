"""A clip's motion as the body that it wears makes it: to be encoded, edited or written with that body."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from qmd_studio.avatar.humanoid import Body
from qmd_studio.errors import EditError
from qmd_studio.motion.bap_body import bap_skeleton_like, is_hanim
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Skeleton, SkeletonKind
from qmd_studio.project.clip import Clip, Outfit

if TYPE_CHECKING:
    from qmd_studio.motion.retarget import RetargetResult


def bake(clip: Clip) -> Clip:
    """Return a new clip whose motion is that of the body which `clip` wears, in body animation parameters.

    A body without H-Anim's joints takes columns of its own. Raises `EditError` where the clip wears its own bones.
    """
    avatar = _avatar(clip)
    target = bap_skeleton_like(avatar.skeleton) if is_hanim(avatar.skeleton) else avatar.skeleton
    result = _retargeted(clip, target)
    return Clip(
        name=f"{clip.name} on {avatar.name}",
        motion=result.motion,
        body=clip.body if clip.body is avatar else None,
        outfit=Outfit(avatar),
        notes=(*result.notes, *report_of(result)),
    )


def figure_of(clip: Clip) -> tuple[Body, Motion]:
    """Return the body that `clip` is shown on and its motion on that body's own skeleton, as files hold them."""
    from qmd_studio.avatar.fit import has_joints_of, made_of_bones

    avatar = clip.outfit.avatar
    if avatar is None:
        return made_of_bones(clip.motion.skeleton), clip.motion
    if clip.outfit.joint_map is None and avatar.skeleton == clip.motion.skeleton:
        return avatar, clip.motion
    names = [[joint.name for joint in skeleton.joints] for skeleton in (avatar.skeleton, clip.motion.skeleton)]
    if names[0] == names[1] and has_joints_of(avatar.skeleton, clip.motion.skeleton):
        return replace(avatar, skeleton=clip.motion.skeleton), clip.motion
    return avatar, _retargeted(clip, avatar.skeleton).motion


def motion_for(clip: Clip, suffix: str) -> Motion:
    """Return the motion that a file with `suffix` takes: for .bap that of the body, where the clip has no BAPs."""
    wears = clip.outfit.avatar
    if suffix.lower() != ".bap" or clip.motion.skeleton.kind is SkeletonKind.BAP or wears is None:
        return clip.motion
    return bake(clip).motion if is_hanim(wears.skeleton) else clip.motion


def report_of(result: RetargetResult) -> tuple[str, ...]:
    """Return in sentences how well a motion went onto another body."""
    sentences = [
        f"{len(result.mapped)} joints follow the motion, each {result.mean_angle_error_deg:.1f}° off on average",
    ]
    if result.unmapped:
        sentences.append(f"joints that move nothing: {', '.join(result.unmapped)}")
    if result.clamped_share > 0:
        sentences.append(f"{100 * result.clamped_share:.1f} % of the angles lie outside anatomical limits")
    return tuple(sentences)


def _retargeted(clip: Clip, target: Skeleton) -> RetargetResult:
    from qmd_studio.avatar.upright import upright
    from qmd_studio.motion.joint_map import JointMap
    from qmd_studio.motion.retarget import retargeting

    outfit, joint_map = clip.outfit, clip.outfit.joint_map
    if joint_map is not None:  # it was made for the body's joints; the target may have fewer
        known = {joint.name for joint in target.joints}
        joint_map = JointMap(tuple((s, tuple(t for t in ts if t in known)) for s, ts in joint_map.pairs))
    way = retargeting(
        clip.motion.skeleton,
        target,
        joint_map=joint_map,
        reference=outfit.reference(clip.motion),
        upright=upright(clip.motion),
    )
    return way.motion(clip.motion)


def _avatar(clip: Clip) -> Body:
    if clip.outfit.avatar is None:
        raise EditError("the clip wears its own bones", hint="Choose a body for it in the Body panel first")
    return clip.outfit.avatar
