"""The shape of trunk, limbs and feet of the left half, clothes included, in metres of the default body."""

from __future__ import annotations

from avatars.make.placing import Placed

TRUNK, ARM, LEG, SHOE = 0, 1, 2, 3
"""Registers; all end in the first, and the others still hold their limb alone."""

_TORSO = (  # y, centre x, centre z, half width, half depth
    (0.832, 0.0, 0.000, 0.104, 0.070),
    (0.860, 0.0, -0.002, 0.140, 0.098),
    (0.900, 0.0, -0.006, 0.1520, 0.108),
    (0.950, 0.0, -0.006, 0.1510, 0.109),
    (1.000, 0.0, -0.005, 0.147, 0.107),
    (1.050, 0.0, -0.005, 0.142, 0.102),
    (1.100, 0.0, -0.006, 0.134, 0.098),
    (1.150, 0.0, -0.006, 0.131, 0.098),
    (1.200, 0.0, -0.005, 0.133, 0.102),
    (1.250, 0.0, -0.003, 0.138, 0.107),
    (1.300, 0.0, 0.000, 0.143, 0.110),
    (1.350, 0.0, -0.001, 0.149, 0.109),
    (1.400, 0.0, -0.006, 0.152, 0.101),
    (1.440, 0.0, -0.014, 0.135, 0.088),
    (1.480, 0.0, -0.022, 0.098, 0.070),
    (1.510, 0.0, -0.028, 0.062, 0.052),
)
_UPPER_ARM = (
    (1.468, 0.1850, -0.0400, 0.036, 0.040),
    (1.430, 0.1915, -0.0400, 0.0390, 0.044),
    (1.380, 0.2005, -0.0410, 0.0400, 0.045),
    (1.330, 0.2025, -0.0430, 0.0385, 0.0445),
    (1.260, 0.2025, -0.0500, 0.0375, 0.0430),
    (1.200, 0.2020, -0.0580, 0.0360, 0.0405),
    (1.1357, 0.2012, -0.0715, 0.0350, 0.0390),
    (1.110, 0.2010, -0.0720, 0.0355, 0.0385),
)
_FOREARM = (
    (1.150, 0.2012, -0.0712, 0.0345, 0.0382),
    (1.1357, 0.2012, -0.0712, 0.0350, 0.0390),
    (1.085, 0.2005, -0.0680, 0.0355, 0.0400),
    (1.030, 0.2000, -0.0640, 0.0340, 0.0380),
    (0.970, 0.1995, -0.0610, 0.0295, 0.0340),
    (0.910, 0.1990, -0.0590, 0.0240, 0.0300),
    (0.866, 0.1985, -0.0583, 0.0210, 0.0280),
    (0.845, 0.1980, -0.0583, 0.0195, 0.0280),
)
_THIGH = (
    (0.960, 0.0720, -0.006, 0.052, 0.072),
    (0.900, 0.0830, -0.004, 0.0640, 0.0850),
    (0.850, 0.0895, -0.001, 0.0740, 0.0910),
    (0.800, 0.0915, 0.002, 0.0730, 0.0880),
    (0.700, 0.0965, 0.008, 0.0690, 0.0810),
    (0.600, 0.1000, 0.012, 0.0630, 0.0730),
    (0.540, 0.1020, 0.012, 0.0580, 0.0660),
    (0.4867, 0.1035, 0.009, 0.0560, 0.0625),
    (0.455, 0.1040, 0.004, 0.0550, 0.0600),
)
_SHANK = (
    (0.520, 0.1030, 0.011, 0.0570, 0.0630),
    (0.4867, 0.1035, 0.008, 0.0565, 0.0630),
    (0.430, 0.1045, -0.004, 0.0550, 0.0610),
    (0.370, 0.1060, -0.020, 0.0560, 0.0620),
    (0.300, 0.1070, -0.034, 0.0545, 0.0600),
    (0.220, 0.1080, -0.048, 0.0510, 0.0560),
    (0.140, 0.1085, -0.062, 0.0490, 0.0550),
    (0.075, 0.1090, -0.069, 0.0490, 0.0560),
)
_FOOT = (  # z, centre x, centre y, half width, half height
    (-0.127, 0.1090, 0.036, 0.030, 0.034),
    (-0.105, 0.1090, 0.044, 0.035, 0.046),
    (-0.070, 0.1095, 0.050, 0.0375, 0.056),
    (-0.030, 0.1105, 0.044, 0.0390, 0.050),
    (0.020, 0.1130, 0.034, 0.0430, 0.040),
    (0.070, 0.1170, 0.027, 0.0480, 0.033),
    (0.110, 0.1190, 0.023, 0.0465, 0.028),
    (0.145, 0.1200, 0.019, 0.0380, 0.023),
    (0.163, 0.1200, 0.017, 0.0240, 0.018),
)


def add_trunk(put: Placed, chest: float) -> None:
    """Add torso, neck and shoulder girdle; `chest` is how far the breast stands out, 1 for the default."""
    put.loft("trunk", 1, _TORSO, caps=(0.05, 0.03), register=TRUNK)
    put.ellipsoid("trunk", (0.074, 0.905, -0.058), (0.072, 0.078, 0.074), k=0.05, register=TRUNK)  # buttock
    put.ellipsoid(
        "trunk", (0.066, 1.325, 0.030 + 0.032 * chest), (0.066, 0.055, 0.046), k=0.045, register=TRUNK
    )  # breast
    put.ellipsoid("trunk", (0.085, 1.330, -0.070), (0.062, 0.085, 0.042), k=0.05, register=TRUNK)  # shoulder blade
    put.cone("trunk", (0.022, 1.512, -0.044), (0.182, 1.431, -0.042), 0.028, 0.039, k=0.040, register=TRUNK)
    put.cone("trunk", (0.030, 1.462, 0.006), (0.160, 1.430, -0.014), 0.026, 0.033, k=0.035, register=TRUNK)  # clavicle
    put.thicken("trunk", 0.0030, (0.0, 1.0, 0.0), 0.975, 0.006, register=TRUNK)  # the shirt over the trousers
    put.cone("neck", (0.0, 1.500, -0.034), (0.0, 1.600, -0.010), 0.0480, 0.0460, k=0.026, register=TRUNK)
    put.cone("neck", (0.010, 1.480, 0.016), (0.038, 1.585, -0.018), 0.012, 0.018, k=0.025, register=TRUNK)


def add_arm(put: Placed, sleeve_y: float) -> None:
    """Add deltoid, upper arm and forearm; a sleeve ends at the level `sleeve_y`."""
    put.loft("upperarm", 1, _UPPER_ARM, caps=(0.015, 0.050), register=ARM)
    put.ellipsoid("upperarm", (0.1975, 1.392, -0.040), (0.0385, 0.070, 0.0460), k=0.02, register=ARM)
    put.loft("forearm", 1, _FOREARM, caps=(0.004, 0.015), k=0.006, register=ARM)
    put.ellipsoid("forearm", (0.1985, 1.1360, -0.1010), (0.015, 0.020, 0.0115), k=0.014, register=ARM)  # elbow's point
    part = "forearm" if sleeve_y < 1.13 else "upperarm"
    put.thicken(part, 0.0030, (0.0, 1.0, 0.0), sleeve_y, 0.004, register=ARM)
    put.join(ARM, into=TRUNK, k=(0.0015, 0.034), levels=[("trunk", 1.350), ("trunk", 1.440)])


def add_leg(put: Placed) -> None:
    """Add thigh, shank and shoe, standing on the ground."""
    put.loft("thigh", 1, _THIGH, caps=(0.03, 0.03), register=LEG)
    put.loft("shank", 1, _SHANK, caps=(0.004, 0.03), k=0.006, register=LEG)
    put.ellipsoid("shank", (0.1040, 0.492, 0.052), (0.030, 0.036, 0.020), k=0.03, register=LEG)  # kneecap
    put.join(LEG, into=TRUNK, k=(0.012, 0.034), levels=[("trunk", 0.815), ("trunk", 0.900)])
    put.loft("foot", 2, _FOOT, caps=(0.014, 0.020), k=0.004, register=SHOE)
    put.thicken("foot", 0.0022, (0.0, -1.0, 0.0), -0.017, 0.003, register=SHOE)  # the sole stands out
    put.above("foot", 0.0, k=0.006, register=SHOE)
    put.join(SHOE, into=TRUNK, k=(0.002, 0.002), levels=[("foot", 0.0), ("foot", 0.2)])
    put.join(SHOE, into=LEG, k=(0.002, 0.002), levels=[("foot", 0.0), ("foot", 0.2)])
