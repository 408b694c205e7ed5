"""A knob in millimetres: the slider goes by equal factors, the box takes any distance."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from qmd_studio.ui.codec_lab_knob import DistanceSpinBox, Knob

_STEPS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
STOPS_MM = (*(round(step * 10.0**decade, 4) for decade in (-2, -1, 0, 1) for step in _STEPS), 100.0)
"""The stops of the slider, 0.01 to 100 mm."""

LIMITS_MM = (0.0001, 10_000.0)


class DistanceKnob(Knob):
    """Says below it what came of the distance: `say` until the distance is another."""

    def __init__(self, name: str, *, title: str, tip: str, default_mm: float, parent: QWidget | None = None) -> None:
        super().__init__(name, title=title, tip=tip, spin=DistanceSpinBox(), parent=parent)
        self.set_stops(STOPS_MM, limits=LIMITS_MM)
        self.show_distance(default_mm)

    def show_distance(self, value_mm: float) -> None:
        """Show a distance; what was said of another goes."""
        if value_mm != self.value:
            self.show_value(value_mm, "")

    def look(self) -> None:
        """Say that what the distance comes to is not known yet."""
        self.say(self.tr("looking for the fewest bytes…"))

    def say(self, words: str) -> None:
        """Say what came of the distance."""
        self.meaning.setText(words)
