"""The compact profile, version 2 of the QMD container: key poses, a transform between them, and a range coder."""

PRIOR_SHAPE = (8, 24, 16)
"""Classes of integers, contexts, and the half octaves of magnitude that have a prior of their own."""
