"""Files in and out of the window: what is chosen, what is read and written in the background, what is remembered."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from qmd_studio import assets
from qmd_studio.errors import QmdStudioError
from qmd_studio.project.clip import Clip
from qmd_studio.project.commands import AddClip
from qmd_studio.project.document import Document
from qmd_studio.ui.dialogs import ask_export, ask_open
from qmd_studio.ui.opener import Opener
from qmd_studio.ui.saver import Saver
from qmd_studio.ui.settings import Settings

SAMPLE = "walk.bap"


class FileDesk(QObject):
    """Opens files into the document and writes its clips.

    `added` has the keys of the clips that came in, `failed` says that a file did not, `written` names one that was;
    `job_changed` says what is under way, "" for nothing.
    """

    added = Signal(list)
    failed = Signal(QmdStudioError)
    written = Signal(object)
    job_changed = Signal(str)

    def __init__(self, document: Document, settings: Settings, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._settings = document, settings
        self._opener, self._saver = Opener(self), Saver(self)
        self._opener.opened.connect(self._add)
        self._opener.failed.connect(self.failed)
        self._saver.saved.connect(self.written)
        self._saver.failed.connect(self.failed)
        self._opener.busy_changed.connect(lambda name: self._say(self.tr("Opening {name}"), name))
        self._saver.busy_changed.connect(lambda name: self._say(self.tr("Writing {name}"), name))

    def open_paths(self, paths: list[Path]) -> None:
        """Open files beside what is open already."""
        self._opener.open(paths)

    def open_sample(self) -> None:
        """Open the sample motion that ships with the studio."""
        self._opener.open([assets.resource("motions", SAMPLE)])

    def open_by_dialog(self, parent: QWidget) -> None:
        """Let the user choose what to open."""
        paths = ask_open(parent, self._settings.folder("open"))
        if paths:
            self._settings.set_folder("open", paths[0].parent)
            self.open_paths(paths)

    def export_by_dialog(self, parent: QWidget) -> None:
        """Let the user choose where to write the shown clip, and in which format."""
        clip = self._document.state.active_clip
        if clip is None:
            return
        path = ask_export(parent, self._settings.folder("export") / f"{clip.name}.bvh")
        if path is not None:
            self._settings.set_folder("export", path.parent)
            self._saver.save(path, clip)

    def cancel(self) -> None:
        """Drop what is being opened; what is being written is finished."""
        self._opener.cancel()

    def finish(self) -> None:
        """Drop what is being opened, and wait for what is being written: before the window goes."""
        self._opener.wait()
        self._saver.wait()

    def _add(self, clips: list[Clip]) -> None:
        samples = assets.resource("motions")
        # A sample is a motion without a file of the user's: nothing is to be exported beside it.
        clips = [replace(clip, path=None) if clip.path and clip.path.parent == samples else clip for clip in clips]
        if len(clips) == 1:
            self._document.execute(AddClip(clips[0]))
        else:
            with self._document.transaction(self.tr("Open {n} files").format(n=len(clips))):
                for clip in clips:
                    self._document.execute(AddClip(clip))
        for clip in clips:
            if clip.path is not None:
                self._settings.add_recent(clip.path)
        self.added.emit([clip.key for clip in self._document.state.clips[-len(clips) :]])

    def _say(self, text: str, name: str) -> None:
        self.job_changed.emit(text.format(name=name) if name else "")
