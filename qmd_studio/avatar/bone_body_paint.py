"""The colours of a body made from bones, linear: pale warm skin, slate joints, dark eyes. Left and right are alike."""

import numpy as np

SKIN = np.array([0.640, 0.610, 0.565])
ACCENT = np.array([0.120, 0.145, 0.180])
EYE = np.array([0.018, 0.022, 0.030])
EXTRA = np.array([0.400, 0.400, 0.395])
