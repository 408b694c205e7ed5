"""The poses that the avatars are looked at in: within the limits, alike on both sides, the thumb where it belongs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from avatars.make.poses import BODIES, HANDS, angles_of, world_of
from qmd_studio.registry import open_file

FOLDER = Path(__file__).resolve().parents[2] / "avatars"


def places(name: str, pose: dict[str, float]) -> dict[str, np.ndarray]:
    body = open_file(FOLDER / name / "avatar.x3d").body
    return dict(zip((j.name for j in body.skeleton.joints), world_of(body, pose)[:, :3, 3], strict=True))


@pytest.mark.parametrize("pose", [*HANDS.values(), *BODIES.values()], ids=[*HANDS, *BODIES])
def test_pose_is_within_the_anatomical_limits_and_mirrored(pose):
    at = places("ada", pose)
    if any(name.startswith(("l_", "r_")) for name in pose):
        return  # one side alone: that no limit is passed is enough
    for joint in at:
        if joint.startswith("l_"):
            np.testing.assert_allclose(at["r_" + joint[2:]], at[joint] * (-1, 1, 1), atol=2e-4)


@pytest.mark.parametrize("pose", [{"l_elbow_flexion": 151.0}, {"elbow_bending": 5.0}], ids=["too far", "unknown"])
def test_pose_that_no_body_can_take_is_refused(pose):
    with pytest.raises(ValueError, match="elbow"):
        angles_of(pose)


@pytest.mark.parametrize("name", ["ada", "tim"])
def test_thumb_comes_before_the_fingers_of_a_fist_and_not_of_an_open_hand(name):
    fist, beside = (places(name, HANDS[pose]) for pose in ("S: fist, thumb across", "L"))
    assert fist["l_thumb3"][0] < fist["l_index2"][0] - 0.01  # the palm looks towards -x
    assert beside["l_thumb3"][0] > beside["l_index1"][0] - 0.02
