"""The default body's stance: within the joints' limits, its own mirror image, its thumbs beside the fingers."""

import numpy as np

from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.bap_ease import at_ease
from qmd_studio.motion.kinematics import rest_values, world_from_joint


def joint_positions(row):
    skeleton = bap_skeleton()
    places = world_from_joint(skeleton, row[None])[0, :, :3, 3]
    return {joint.name: place for joint, place in zip(skeleton.joints, places, strict=True)}


def test_the_stance_is_within_the_limits():
    for column, value in zip(bap_skeleton().columns, at_ease(), strict=True):
        if column.limits is not None:
            assert column.limits[0] <= value <= column.limits[1], column.name


def test_the_stance_is_its_own_mirror_image():
    places = joint_positions(at_ease())
    for name, place in places.items():
        if name.startswith("l_"):
            np.testing.assert_allclose(place * (-1, 1, 1), places["r_" + name[2:]], atol=1e-3, err_msg=name)


def test_the_thumbs_point_down_beside_the_fingers_and_the_arms_clear_the_hips():
    stiff, easy = joint_positions(rest_values(bap_skeleton())), joint_positions(at_ease())
    for side in "lr":
        along = easy[f"{side}_thumb2"] - easy[f"{side}_thumb1"]
        assert -along[1] > 0.5 * np.linalg.norm(along)
        assert abs(easy[f"{side}_wrist"][0]) > abs(stiff[f"{side}_wrist"][0]) + 0.03
