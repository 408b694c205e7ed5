"""The sizes that Tables 1 and 2 of the paper print, for files of 62 columns.

A row is (motion, rows of differences, FDF, bits, rows of a segment or 0 for one segment, KB of 1,024 bytes).
"""

_TABLE_1 = [
    ("jog", 136, 11.9),
    ("run_leap", 251, 20.9),
    ("stride", 298, 24.6),
    ("walk", 343, 28.1),
    ("jump", 351, 28.7),
    ("basketball", 396, 32.3),
    ("forward jump", 415, 33.7),
    ("dance", 434, 35.2),
    ("play piano", 691, 55.3),
    ("play drums", 804, 64.1),
    ("play violin", 804, 64.1),
    ("sword play", 2251, 177.2),
]
_TABLE_2 = [
    ("jog", 136, 11, 9, 30, 29.7),
    ("run_leap", 251, 11, 10, 120, 48.1),
    ("stride", 298, 1, 8, 120, 22.2),
    ("walk", 343, 1, 10, 330, 50.5),
    ("jump", 351, 26, 10, 300, 68.6),
    ("basketball", 396, 11, 10, 210, 64.7),
    ("forward jump", 415, 6, 10, 90, 75.4),
    ("dance", 434, 1, 8, 150, 30.8),
    ("play piano", 691, 26, 10, 60, 167.2),
]
PAPER_SIZES = [(name, n, 6, 8, 0, kb) for name, n, kb in _TABLE_1] + _TABLE_2
