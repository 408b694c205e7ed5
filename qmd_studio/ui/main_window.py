"""The window: the viewport in the middle, the timeline below, the panels around it, and the verbs that join them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QByteArray, Qt, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDragLeaveEvent, QDropEvent, QShowEvent
from PySide6.QtWidgets import QGridLayout, QMainWindow, QVBoxLayout, QWidget

from qmd_studio.errors import QmdStudioError
from qmd_studio.project.commands import RemoveClip, SetCodecSettings
from qmd_studio.project.document import Document
from qmd_studio.project.playhead import Playhead
from qmd_studio.project.state import DocumentState
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.ui.actions import Actions, Needs
from qmd_studio.ui.background import Background
from qmd_studio.ui.banner import BannerArea
from qmd_studio.ui.body_panel import BodyPanel
from qmd_studio.ui.clip_panel import ClipPanel
from qmd_studio.ui.dialogs import AboutDialog, ShortcutsDialog
from qmd_studio.ui.dock_title import DockTitle
from qmd_studio.ui.dressing_room import DressingRoom
from qmd_studio.ui.drop import DropHighlight, dropped_files, dropped_folders
from qmd_studio.ui.encoder_verbs import encoder_handlers, encoder_verb
from qmd_studio.ui.file_desk import FileDesk
from qmd_studio.ui.focus_ring import FocusRing
from qmd_studio.ui.help_dialog import HelpDialog
from qmd_studio.ui.icons import application_icon, icon
from qmd_studio.ui.look_switch import LookSwitch
from qmd_studio.ui.menus import Menus, tool_bar
from qmd_studio.ui.outliner import Outliner
from qmd_studio.ui.panels import LAB_MIN_WIDTH, arrange, dock, scrolling
from qmd_studio.ui.player import Player
from qmd_studio.ui.settings import LAYOUT_VERSION, Settings
from qmd_studio.ui.stage import Stage, prepare_furnishing
from qmd_studio.ui.status import StatusBar
from qmd_studio.ui.theme import Theme, ThemeSwitch
from qmd_studio.ui.timeline import Timeline
from qmd_studio.ui.transport import transport_handlers
from qmd_studio.ui.view_switch import ViewSwitch
from qmd_studio.ui.viewport import Viewport
from qmd_studio.ui.wardrobe import Wardrobe

if TYPE_CHECKING:
    from qmd_studio.ui.codec_lab import CodecLab
    from qmd_studio.ui.codec_lab_export import AskPath
    from qmd_studio.ui.error_strip import ErrorStrip

DEFAULT_SIZE = (1440, 900)


class MainWindow(QMainWindow):
    """Owns the document and the playhead.

    `furnished` is emitted once, when what the first picture could do without has come.
    """

    furnished = Signal()

    def __init__(self, settings: Settings, themes: ThemeSwitch) -> None:
        super().__init__()
        self.settings, self.themes = settings, themes
        self.document, self.playhead = Document(), Playhead()
        self.lab: CodecLab | None = None
        self.strip: ErrorStrip | None = None
        self.ask_export_path: AskPath | None = None
        self._is_furnished = False
        self._furnishing = Background("furnishing", self)
        self._shown_clip: int | None = None
        self._after_furnishing: list[Callable[[], None]] = []
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        self.setDockNestingEnabled(True)
        self.resize(*DEFAULT_SIZE)
        self.verbs = Actions(self)
        self.files = FileDesk(self.document, settings, self)
        self._make_centre()
        self._make_panels()
        self._make_bars()
        self.stage = Stage(self.viewport, self.playhead, self)
        self.views, self.looks = ViewSwitch(self), LookSwitch(self)
        self.dressing = DressingRoom(self)
        self.player = Player(self.playhead, self)
        self.verbs.connect_all(self._handlers())
        self.verbs["follow"].setChecked(self.stage.follows)
        self._connect()
        self._first_state = self.saveState(LAYOUT_VERSION)
        self._restore_layout()
        self._follow_theme()
        self._follow(self.document.state)

    # What the window consists of

    def _make_centre(self) -> None:
        self.viewport = Viewport()
        self.banners = BannerArea()
        self.timeline = Timeline(self.playhead, self.verbs)
        centre, view = QWidget(), QWidget()
        grid = QGridLayout(view)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(self.viewport, 0, 0)
        grid.addWidget(FocusRing(self.viewport), 0, 0)
        grid.addWidget(self.banners, 0, 0, Qt.AlignmentFlag.AlignTop)
        self.drop_highlight = DropHighlight()
        grid.addWidget(self.drop_highlight, 0, 0)
        column = QVBoxLayout(centre)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(view, 1)
        column.addWidget(self.timeline)
        self.setCentralWidget(centre)

    def _make_panels(self) -> None:
        self.outliner, self.clip_panel = Outliner(self.document), ClipPanel(self.document)
        self.wardrobe = Wardrobe(self)
        self.body_panel = BodyPanel(self.document, self.playhead, self.wardrobe)
        room = QWidget()
        room.setMinimumWidth(LAB_MIN_WIDTH)
        self.outliner_dock = dock(self, "OutlinerDock", self.tr("Outliner"), self.outliner)
        self.clip_dock = dock(self, "ClipDock", self.tr("Clip"), scrolling(self.clip_panel))
        self.body_dock = dock(self, "BodyDock", self.tr("Body"), scrolling(self.body_panel))
        self.lab_dock = dock(self, "LabDock", self.tr("Codec lab"), room)
        arrange(self, self.outliner_dock, (self.clip_dock, self.body_dock), self.lab_dock)

    def _make_bars(self) -> None:
        self.menus = Menus(
            self,
            self.verbs,
            recent=lambda: self.settings.recent,
            open_recent=lambda path: self.open_paths([path]),
            clear_recent=self.settings.clear_recent,
        )
        docks = (self.outliner_dock, self.clip_dock, self.body_dock, self.lab_dock)
        self.menus.add_panels([d.toggleViewAction() for d in docks])
        self.tools = tool_bar(self, self.verbs)
        self.addToolBar(self.tools)
        self.status = StatusBar(self.playhead)
        self.setStatusBar(self.status)

    def _handlers(self) -> dict[str, Callable[[], object]]:
        view = self.viewport.view_preset
        return {
            **transport_handlers(self.playhead),
            "open": lambda: self.files.open_by_dialog(self),
            "export_qmd": self.export_qmd,
            "export_as": lambda: self.files.export_by_dialog(self),
            "close_clip": self._close_clip,
            "quit": self.close,
            "undo": self.document.undo,
            "redo": self.document.redo,
            "rename_clip": self.outliner.rename_active,
            "dismiss": self.banners.dismiss_newest,
            "frame_all": self.viewport.frame_all,
            "frame_selection": self.viewport.frame_selection,
            "follow": self._toggle_follow,
            "view_front": lambda: view("front"),
            "view_back": lambda: view("back"),
            "view_left": lambda: view("left"),
            "view_right": lambda: view("right"),
            "view_top": lambda: view("top"),
            "view_three_quarter": lambda: view("three-quarter"),
            "orthographic": self.viewport.toggle_orthographic,
            **self.views.handlers(),
            **self.looks.handlers(),
            **self.dressing.handlers(),
            **{f"theme_{theme}": lambda t=theme: self._choose_theme(t) for theme in Theme},
            "full_screen": self._toggle_full_screen,
            "reset_layout": self.reset_layout,
            "go_to": self.timeline.edit_place,
            "next_worst": lambda: self.strip and self.strip.go_to_next(),
            "previous_worst": lambda: self.strip and self.strip.go_to_previous(),
            "reset_codec": lambda: self.document.execute(SetCodecSettings(EncodeSettings())),
            **encoder_handlers(self.document),
            "column_levels": lambda: self.lab and self.lab.open_levels(),
            "help": lambda: HelpDialog(self).show(),
            "shortcuts": lambda: ShortcutsDialog(self).show(),
            "about": lambda: AboutDialog(self).show(),
        }

    def _connect(self) -> None:
        self.document.changed.connect(self._follow)
        self.themes.changed.connect(self._follow_theme)
        self.files.added.connect(self._take_in)
        self.files.failed.connect(self.show_problem)
        self.files.written.connect(lambda path: self.show_message("info", self.tr("Written"), [str(path)]))
        self.files.job_changed.connect(self.status.show_job)
        self.status.cancelled.connect(self.files.cancel)
        self.viewport.joint_picked.connect(self._pick_joint)
        self.viewport.failed.connect(lambda message: self.show_problem(QmdStudioError(message)))
        self.outliner.joint_selected.connect(self._select_joint)
        self.outliner.warnings_wanted.connect(self.show_warnings)
        for panel in (self.outliner, self.clip_panel, self.body_panel, self.timeline):
            panel.refused.connect(self.show_problem)

    # After the first picture

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not self._is_furnished:
            self.viewport.frameSwapped.connect(self._furnish_soon, Qt.ConnectionType.SingleShotConnection)
            QTimer.singleShot(1500, self.furnish)  # a window that cannot draw is furnished all the same

    def _furnish_soon(self) -> None:
        self._furnishing.ended.connect(lambda _nothing: self.furnish())
        self._furnishing.run(prepare_furnishing)  # that takes a while, which the window need not be deaf for

    def furnish(self) -> None:
        """Bring in the codec lab, the default body and the compiled kernels; once, after the first picture."""
        if self._is_furnished:
            return
        self._is_furnished = True
        from qmd_studio.ui.furnishing import furnish_window

        furnish_window(self)
        self.furnished.emit()
        for action in self._after_furnishing:
            action()

    @property
    def is_furnished(self) -> bool:
        """Whether the codec lab and the default body are there."""
        return self._is_furnished

    def when_furnished(self, action: Callable[[], None]) -> None:
        """Do `action` as soon as the window is furnished."""
        if self._is_furnished:
            action()
        else:
            self._after_furnishing.append(action)

    # Files

    def open_paths(self, paths: list[Path]) -> None:
        """Open files beside what is open already; each that cannot be opened gives a message."""
        self.files.open_paths(paths)

    def export_qmd(self) -> None:
        """Write the bytes that were measured beside the clip's own file."""
        if self.lab is not None:
            self.lab.export()

    def _take_in(self, keys: list[int]) -> None:
        for key in keys:
            if self.document.state.clip(key).warnings:
                self.show_warnings(key)
        self.playhead.seek(0.0)
        self.playhead.playing = self.playhead.n_frames > 1

    def _close_clip(self) -> None:
        if self.document.state.active is not None:
            self.document.execute(RemoveClip(self.document.state.active))

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if paths := dropped_files(event.mimeData()):
            event.acceptProposedAction()
            self.drop_highlight.invite(paths)

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:
        self.drop_highlight.hide()

    def dropEvent(self, event: QDropEvent) -> None:
        self.drop_highlight.hide()
        paths, folders = dropped_files(event.mimeData()), dropped_folders(event.mimeData())
        if paths:
            event.acceptProposedAction()
            self.activateWindow()
            self.open_paths(paths)
        if folders:
            lines = [*map(str, folders), self.tr("Drop the files that are in it.")]
            self.show_message("warning", self.tr("A folder is not opened"), lines)

    # Messages

    def show_problem(self, problem: QmdStudioError) -> None:
        """Show an error inside the window."""
        self.banners.show_error(problem, self.themes.colours.error)

    def show_message(self, kind: str, title: str, lines: list[str]) -> None:
        """Show a message of `kind` "error", "warning" or "info" inside the window."""
        self.banners.show_message(kind, title, lines, getattr(self.themes.colours, kind))

    def show_warnings(self, key: int) -> None:
        """Show what the reader of the clip `key` warned of."""
        clip = self.document.state.clip(key)
        self.show_message("warning", self.tr("Warnings of {name}").format(name=clip.name), list(clip.warnings))

    # Following the document

    def _follow(self, state: DocumentState) -> None:
        clip = state.active_clip
        if clip is not None:
            self.playhead.set_clip(clip.motion.n_frames, clip.motion.fps)
        else:
            self.playhead.playing = False
            self.playhead.set_clip(1, 30.0)
        self.stage.show_clip(clip)
        if state.active != self._shown_clip:
            self.viewport.frame_all()
        self._shown_clip = state.active
        self.status.show_clips(len(state.clips))
        self.setWindowTitle(f"{clip.name} — QMD Studio" if clip else "QMD Studio")
        self.verbs[encoder_verb(state.codec)].setChecked(True)
        self._name_history()
        self.enable_verbs()

    def _name_history(self) -> None:
        document = self.document
        self.verbs["undo"].setText(self.tr("&Undo {what}").format(what=document.undo_text.lower()).rstrip())
        self.verbs["redo"].setText(self.tr("&Redo {what}").format(what=document.redo_text.lower()).rstrip())

    def enable_verbs(self) -> None:
        """Enable the verbs that make sense now."""
        clip = self.document.state.active_clip
        present = {
            Needs.CLIP: clip is not None,
            Needs.FRAMES: clip is not None and clip.motion.n_frames > 1,
            Needs.SELECTION: clip is not None and self.viewport.scene.selected is not None,
            Needs.AVATAR: clip is not None and clip.outfit.avatar not in (None, clip.body),
            Needs.DECODED: self.stage.has_decoded,
            Needs.UNDO: self.document.can_undo,
            Needs.REDO: self.document.can_redo,
        }
        self.verbs.enable({need for need, there in present.items() if there})

    def _pick_joint(self, joint: int) -> None:
        self.outliner.select_joint(self.stage.joint_of_clip(joint))
        self.enable_verbs()

    def _select_joint(self, joint: int) -> None:
        self.viewport.select_joint(self.stage.joint_of_body(joint))
        self.enable_verbs()

    # The look

    def _toggle_follow(self) -> None:
        self.stage.follows = self.verbs["follow"].isChecked()

    def _choose_theme(self, theme: Theme) -> None:
        self.settings.theme = theme.value
        self.themes.choose(theme)

    def _follow_theme(self) -> None:
        self.verbs[f"theme_{self.themes.theme}"].setChecked(True)
        self.verbs.refresh_icons()
        self.timeline.refresh()
        self.outliner.refresh_icons()
        self.status.refresh_icons()
        for title in self.findChildren(DockTitle):
            title.refresh_icons()
        for name, drawn in (("ViewFrom", "view"), ("CompareBy", "compare")):
            for button in self.tools.findChildren(QWidget, name):
                button.setIcon(icon(drawn))
        for banner in self.banners.banners:
            banner.draw_icons(getattr(self.themes.colours, banner.kind))
        self.viewport.set_theme(self.themes.dark)
        self.views.set_dark(self.themes.dark)
        self.looks.follow()

    def _toggle_full_screen(self) -> None:
        if self.isFullScreen():
            self.showNormal()
        else:
            self.showFullScreen()

    def reset_layout(self) -> None:
        """Put every panel back where it was at first."""
        self.restoreState(self._first_state, LAYOUT_VERSION)
        arrange(self, self.outliner_dock, (self.clip_dock, self.body_dock), self.lab_dock)

    def _restore_layout(self) -> None:
        layout = self.settings.layout()
        if layout is not None:
            geometry, state = layout
            self.restoreGeometry(geometry)
            self.restoreState(state, LAYOUT_VERSION)

    def layout_state(self) -> tuple[QByteArray, QByteArray]:
        """Return the window's geometry and the docks' state, as they are remembered."""
        return self.saveGeometry(), self.saveState(LAYOUT_VERSION)

    def closeEvent(self, event: QCloseEvent) -> None:
        self.playhead.playing = False
        self.settings.set_layout(*self.layout_state())
        self.settings.sync()
        self.files.finish()
        self._furnishing.close()
        self.wardrobe.close_down()
        self.dressing.close_down()
        if self.lab is not None:
            self.lab.close_down()
        super().closeEvent(event)
