"""The heat map's numbers: which joint is as hot as what."""

import numpy as np

from qmd_studio.tuning.joint_heat import heat_of, joint_errors
from tests.generated_motion import walker_skeleton


def test_a_bone_is_as_far_off_as_its_worst_end():
    skeleton = walker_skeleton()
    distance = np.zeros((3, len(skeleton.points)), np.float32)
    toes = skeleton.point_names.index("rtoes_end")
    distance[1, toes] = 7.0
    names = [joint.name for joint in skeleton.joints]
    errors = dict(zip(names, joint_errors(skeleton, distance, 1), strict=True))
    assert errors.pop("rtoes") == 7.0
    assert set(errors.values()) == {0.0}
    assert not joint_errors(skeleton, distance, 0).any()


def test_an_inner_point_heats_its_own_bone_and_its_parents():
    skeleton = walker_skeleton()
    names = [joint.name for joint in skeleton.joints]
    distance = np.zeros((1, len(skeleton.points)), np.float32)
    distance[0, skeleton.point_names.index("rtibia")] = 2.0
    errors = dict(zip(names, joint_errors(skeleton, distance, 0), strict=True))
    assert {name for name, error in errors.items() if error} == {"rfemur", "rtibia"}


def test_every_joint_has_an_error_and_the_scale_ends_at_its_range():
    skeleton = walker_skeleton()
    distance = np.random.default_rng(1).uniform(0, 5, (2, len(skeleton.points))).astype(np.float32)
    errors = joint_errors(skeleton, distance, 0)
    assert np.isfinite(errors).all()
    assert errors.max() == distance[0].max()
    np.testing.assert_allclose(heat_of(np.array([0.0, 0.5, 1.0, 9.0]), 1.0), [0.0, 0.5, 1.0, 1.0])
