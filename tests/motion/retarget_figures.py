"""Figures in many programs' namings and rest poses, for the tests of retargeting."""

from __future__ import annotations

import numpy as np

from qmd_studio.motion.channels import POSITIONS, ROTATIONS_ZYX, channel_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import EndSite

BONES = {  # part: (parent, offset in a T-pose, metres)
    "root": (None, (0.0, 0.95, 0.0)),
    "spine1": ("root", (0.0, 0.1, 0.0)),
    "spine2": ("spine1", (0.0, 0.18, 0.0)),
    "neck": ("spine2", (0.0, 0.2, 0.0)),
    "head": ("neck", (0.0, 0.1, 0.02)),
    "clavicle": ("spine2", (0.04, 0.14, 0.0)),
    "shoulder": ("clavicle", (0.14, 0.0, 0.0)),
    "elbow": ("shoulder", (0.29, 0.0, 0.0)),
    "wrist": ("elbow", (0.25, 0.0, 0.0)),
    "hip": ("root", (0.1, -0.03, 0.0)),
    "knee": ("hip", (0.0, -0.42, 0.0)),
    "ankle": ("knee", (0.0, -0.42, 0.0)),
    "toe": ("ankle", (0.0, -0.05, 0.14)),
}
ENDS = {"head": (0.0, 0.18, 0.0), "wrist": (0.17, 0.0, 0.0), "toe": (0.0, 0.0, 0.06)}
SIDED = ("clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")

NAMINGS = {  # as the programs' own files have them
    "cmu": "root lowerback thorax lowerneck head {s}clavicle {s}humerus {s}radius {s}hand {s}femur {s}tibia "
    "{s}foot {s}toes",
    "cgspeed": "Hips LowerBack Spine1 Neck Head {Side}Shoulder {Side}Arm {Side}ForeArm {Side}FingerBase "
    "{Side}UpLeg {Side}Leg {Side}Foot {Side}ToeBase",
    "mixamo": "mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Neck mixamorig:Head "
    "mixamorig:{Side}Shoulder mixamorig:{Side}Arm mixamorig:{Side}ForeArm mixamorig:{Side}Hand "
    "mixamorig:{Side}UpLeg mixamorig:{Side}Leg mixamorig:{Side}Foot mixamorig:{Side}ToeBase",
    "motionbuilder": "Character1_Hips Character1_Spine Character1_Spine1 Character1_Neck Character1_Head "
    "Character1_{Side}Shoulder Character1_{Side}Arm Character1_{Side}ForeArm Character1_{Side}Hand "
    "Character1_{Side}UpLeg Character1_{Side}Leg Character1_{Side}Foot Character1_{Side}ToeBase",
    "neuron": "Hips Spine Spine1 Neck Head {Side}Shoulder {Side}Arm {Side}ForeArm {Side}Hand {Side}UpLeg "
    "{Side}Leg {Side}Foot {Side}Toe",
    "lafan1": "Hips Spine Spine1 Neck Head {Side}Shoulder {Side}Arm {Side}ForeArm {Side}Hand {Side}UpLeg "
    "{Side}Leg {Side}Foot {Side}Toe",
    "rokoko": "Hips Spine1 Spine2 Neck Head {Side}Shoulder {Side}Arm {Side}ForeArm {Side}Hand {Side}Thigh "
    "{Side}Shin {Side}Foot {Side}Toe",
    "xsens": "Hips Chest Chest2 Neck Head {Side}Collar {Side}Shoulder {Side}Elbow {Side}Wrist {Side}Hip "
    "{Side}Knee {Side}Ankle {Side}Toe",
    "mvn": "Pelvis L5 T8 Neck Head {Side}Shoulder {Side}UpperArm {Side}ForeArm {Side}Hand {Side}UpperLeg "
    "{Side}LowerLeg {Side}Foot {Side}Toe",
    "biovision": "Hips Chest Chest2 Neck Head {Side}Collar {Side}UpArm {Side}LowArm {Side}Hand {Side}UpLeg "
    "{Side}LowLeg {Side}Foot {Side}Toe",
    "mixed": "Hips Spine Spine1 Neck Head {Side}Collar {Side}Shoulder {Side}ForeArm {Side}Hand {Side}UpLeg "
    "{Side}Leg {Side}Foot {Side}ToeBase",
    "azure kinect": "PELVIS SPINE_NAVEL SPINE_CHEST NECK HEAD CLAVICLE_{SIDE} SHOULDER_{SIDE} ELBOW_{SIDE} "
    "WRIST_{SIDE} HIP_{SIDE} KNEE_{SIDE} ANKLE_{SIDE} FOOT_{SIDE}",
    "biped": "Bip01_Pelvis Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head Bip01_{S}_Clavicle "
    "Bip01_{S}_UpperArm Bip01_{S}_Forearm Bip01_{S}_Hand Bip01_{S}_Thigh Bip01_{S}_Calf "
    "Bip01_{S}_Foot Bip01_{S}_Toe0",
    "H-Anim 1": "HumanoidRoot vl5 vt1 vc7 skullbase {s}_sternoclavicular {s}_shoulder {s}_elbow {s}_wrist {s}_hip "
    "{s}_knee {s}_ankle {s}_metatarsal",
    "H-Anim 2": "humanoid_root vl5 vt1 vc7 skullbase {s}_sternoclavicular {s}_shoulder {s}_elbow {s}_radiocarpal "
    "{s}_hip {s}_knee {s}_talocrural {s}_metatarsophalangeal_2",
    "unknown": "b0 b1 b2 b3 b4 b5{s} b6{s} b7{s} b8{s} b9{s} b10{s} b11{s} b12{s}",
}


def names_in(naming):
    """Return the name of each part, sided ones as "l_knee"."""
    names = {}
    for part, pattern in zip(BONES, NAMINGS[naming].split(), strict=True):
        for side, word in (("l_", "left"), ("r_", "right")) if part in SIDED else (("", ""),):
            marks = {"s": side[:1], "S": side[:1].upper(), "Side": word.capitalize(), "SIDE": word.upper()}
            names[side + part] = pattern.format(**marks)
    return names


def turn_z(angle):
    s, c = np.sin(angle), np.cos(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def figure(naming="mixamo", *, arms_down=0.0, scale=1.0, up=None):
    """A figure whose arms rest `arms_down` radians below a T-pose, as BVH has it; `up` (3, 3) turns its whole file."""
    names, up = names_in(naming), np.eye(3) if up is None else up
    joints, sites, number = [], [], {}
    for part, (parent, offset) in BONES.items():
        for side, sign in (("l_", 1.0), ("r_", -1.0)) if part in SIDED else (("", 1.0),):
            key = side + part
            above = None if parent is None else (side + parent if parent in SIDED else parent)
            way = resting(key, offset, sign, arms_down)
            number[key] = len(joints)
            channels = (POSITIONS if parent is None else ()) + ROTATIONS_ZYX
            place = tuple(float(v) for v in scale * (up @ way))
            joints.append((names[key], -1 if above is None else number[above], place, channels))
            if part in ENDS:
                end = resting(side + "palm" if part == "wrist" else key, ENDS[part], sign, arms_down)
                sites.append(EndSite(f"{names[key]} end", number[key], tuple(float(v) for v in scale * (up @ end))))
    order = depth_first([parent for _, parent, _, _ in joints])
    place = {old: new for new, old in enumerate(order)}
    joints = [(n, place.get(p, -1), o, c) for n, p, o, c in (joints[k] for k in order)]
    return channel_skeleton(joints, [EndSite(s.name, place[s.joint], s.offset) for s in sites])


def resting(key, offset, sign, arms_down):
    way = np.array(offset) * (sign, 1.0, 1.0)
    if key[2:] in ("elbow", "wrist", "palm"):
        way = turn_z(-sign * arms_down) @ way
    return way


def depth_first(parents):
    children = [[k for k, p in enumerate(parents) if p == j] for j in range(len(parents))]
    order, todo = [], [0]
    while todo:
        order.append(todo.pop())
        todo += reversed(children[order[-1]])
    return order


def swinging(skeleton, n_frames=40, *, reach=0.5, seed=3):
    """A smooth motion of every column of `skeleton`."""
    random = np.random.default_rng(seed)
    t = np.linspace(0, 1, n_frames)[:, None]
    X = reach * np.sin(
        2 * np.pi * (t * random.uniform(0.5, 2, skeleton.n_columns)) + random.uniform(0, 6, skeleton.n_columns)
    )
    for k, column in enumerate(skeleton.columns):
        if column.unit == "m":
            X[:, k] = 0.2 * X[:, k] + column.rest
    return Motion(skeleton, X, 60.0)
