"""The verbs of the Body menu: what a clip wears, its joint map, and its motion made the body's own."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip
from qmd_studio.ui.background import Background, Tell
from qmd_studio.ui.body_panel import ask_body
from qmd_studio.ui.joint_map_dialog import JointMapDialog

if TYPE_CHECKING:
    from qmd_studio.ui.main_window import MainWindow


class DressingRoom(QObject):
    """Does the verbs of the Body menu in one window."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._baking = Background("bake", self)
        self._baking.ended.connect(self._take)
        self._baking.failed.connect(self._fail)
        panel = window.body_panel
        panel.file_wanted.connect(self._ask_file)
        panel.map_wanted.connect(self._edit_map)
        panel.bake_wanted.connect(self._bake)

    def handlers(self) -> dict[str, Callable[[], object]]:
        """Return what the verbs do."""
        return {
            "wear_default": self._wear_default,
            "wear_bones": lambda: self._window.body_panel.wear(None),
            "wear_file": self._ask_file,
            "joint_map": self._edit_map,
            "bake": self._bake,
        }

    def close_down(self) -> None:
        """Stop what is under way, before the window goes."""
        self._baking.close()

    def _wear_default(self) -> None:
        names = self._window.wardrobe.names
        if names:
            self._window.wardrobe.fetch(names[0])

    def _ask_file(self) -> None:
        window = self._window
        path = ask_body(window, window.settings.folder("body"))
        if path is not None:
            window.settings.set_folder("body", path.parent)
            window.wardrobe.fetch(path)

    def _edit_map(self) -> None:
        clip = self._window.document.state.active_clip
        if clip is not None and clip.outfit.avatar is not None:
            JointMapDialog(self._window.document, clip.key, self._window).open()

    def _bake(self) -> None:
        clip = self._window.document.state.active_clip
        if clip is None:
            return

        def work(_stop: Event, _tell: Tell) -> Clip:
            from qmd_studio.project.baking import bake
            from qmd_studio.ui.stage import prepare

            baked = bake(clip)
            prepare(baked)
            return baked

        self._window.status.show_job(self.tr("Baking {name}").format(name=clip.name))
        self._baking.run(work)

    def _take(self, clip: Clip) -> None:
        self._window.status.show_job("")
        self._window.document.execute(AddClip(clip))

    def _fail(self, problem: object) -> None:
        self._window.status.show_job("")
        self._window.show_problem(problem)
