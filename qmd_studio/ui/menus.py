"""The menu bar and the tool bar, laid out from the table of verbs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QObject, QSize, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QMenu, QToolBar, QToolButton

from qmd_studio.ui.actions import Actions
from qmd_studio.ui.icons import icon

ICON_SIZE = 20


class Menus(QObject):
    """The window's menus. `fill_recent` gives the recent files when that menu opens, `open_recent` opens one."""

    def __init__(
        self,
        window: QMainWindow,
        actions: Actions,
        *,
        recent: Callable[[], list[Path]],
        open_recent: Callable[[Path], None],
        clear_recent: Callable[[], None],
    ) -> None:
        super().__init__(window)
        self._window, self._actions = window, actions
        self._recent, self._open_recent, self._clear_recent = recent, open_recent, clear_recent
        self.recent_menu = QMenu(self.tr("Open &recent"), window)
        self.recent_menu.setToolTipsVisible(True)
        self.recent_menu.aboutToShow.connect(self.fill_recent)
        self.view_menu = self._menu(self.tr("&View"))
        self._build()

    def fill_recent(self) -> None:
        """List the recent files that still exist."""
        menu = self.recent_menu
        menu.clear()
        paths = self._recent()
        for place, path in enumerate(paths):
            action = menu.addAction(f"&{place + 1}  {path.name}" if place < 9 else path.name)
            action.setToolTip(str(path))
            action.triggered.connect(lambda _checked=False, path=path: self._open_recent(path))
        if paths:
            menu.addSeparator()
            menu.addAction(self.tr("&Clear this list")).triggered.connect(lambda _checked=False: self._clear_recent())
        else:
            menu.addAction(self.tr("No file has been opened yet")).setEnabled(False)

    def add_panels(self, toggles: list[QAction]) -> None:
        """Offer to show and hide the panels, in the View menu."""
        panels = self._menu(self.tr("&Panels"))
        panels.addActions(toggles)
        self.view_menu.insertMenu(self._actions["full_screen"], panels)

    def _build(self) -> None:
        bar = self._window.menuBar()
        file = bar.addMenu(self._menu(self.tr("&File"), "file")).menu()
        file.insertMenu(file.actions()[1], self.recent_menu)
        bar.addMenu(self._menu(self.tr("&Edit"), "edit"))
        view = self.view_menu
        self._fill(view, "view")
        bar.addMenu(view)
        view.insertMenu(self._actions["show_original"], self._menu(self.tr("View fro&m"), "view_from"))
        view.insertMenu(self._actions["show_original"], self._menu(self.tr("Loo&k"), "look"))
        view.insertSeparator(self._actions["show_original"])
        view.insertMenu(self._actions["heat_map"], self._menu(self.tr("&Compare by"), "compare"))
        view.insertMenu(self._actions["full_screen"], self._menu(self.tr("T&heme"), "theme"))
        bar.addMenu(self._menu(self.tr("&Animate"), "animate"))
        bar.addMenu(self._menu(self.tr("&Body"), "body"))
        compress = bar.addMenu(self._menu(self.tr("&Compress"))).menu()
        compress.addAction(self._actions["export_qmd"])
        compress.addSeparator()
        compress.addMenu(self._menu(self.tr("&Encoder"), "encoder"))
        compress.addAction(self._actions["reset_codec"])
        bar.addMenu(self._menu(self.tr("&Help"), "help"))

    def _menu(self, title: str, name: str = "") -> QMenu:
        menu = QMenu(title, self._window)
        menu.setToolTipsVisible(True)
        self._fill(menu, name)
        return menu

    def _fill(self, menu: QMenu, name: str) -> None:
        for action in self._actions.in_menu(name) if name else ():
            if action is None:
                menu.addSeparator()
            else:
                menu.addAction(action)


def tool_bar(window: QMainWindow, actions: Actions) -> QToolBar:
    """Return the window's tool bar: files, history, camera, and which motion is shown."""
    bar = QToolBar(QCoreApplication.translate("Menus", "Tool bar"), window)
    bar.setObjectName("ToolBar")
    bar.setMovable(False)
    bar.setIconSize(QSize(ICON_SIZE, ICON_SIZE))
    bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
    for group in (("open", "export_qmd"), ("undo", "redo"), ("frame_all", "frame_selection")):
        bar.addActions([actions[verb] for verb in group])
        bar.addSeparator()
    bar.addWidget(_view_button(bar, actions))
    bar.addWidget(_look_button(bar, actions))
    bar.addSeparator()
    bar.addActions([actions[verb] for verb in ("show_original", "show_both", "show_decoded")])
    bar.addWidget(_compare_button(bar, actions))
    bar.addAction(actions["heat_map"])
    for button in bar.findChildren(QToolButton):
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        if button.defaultAction() is not None:
            button.setAccessibleName(button.defaultAction().text().replace("&", ""))
    button = bar.widgetForAction(actions["export_qmd"])
    if isinstance(button, QToolButton):
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
    return bar


def _view_button(bar: QToolBar, actions: Actions) -> QToolButton:
    button = _popup(bar, actions, "view_from")
    button.setObjectName("ViewFrom")
    button.setIcon(icon("view"))
    button.setToolTip(QCoreApplication.translate("Menus", "Look from the front, a side or above"))
    button.setAccessibleName(QCoreApplication.translate("Menus", "View from"))
    return button


def _look_button(bar: QToolBar, actions: Actions) -> QToolButton:
    button = _popup(bar, actions, "look")
    button.setObjectName("Look")
    button.setIcon(icon("look-solid"))
    button.setToolTip(QCoreApplication.translate("Menus", "Show bodies solid, in segments, by X-ray or as a wireframe"))
    button.setAccessibleName(QCoreApplication.translate("Menus", "Look"))
    return button


def _compare_button(bar: QToolBar, actions: Actions) -> QToolButton:
    button = _popup(bar, actions, "compare")
    button.setObjectName("CompareBy")
    button.setIcon(icon("compare"))
    button.setToolTip(QCoreApplication.translate("Menus", "How A and B are seen together"))
    button.setAccessibleName(QCoreApplication.translate("Menus", "Compare by"))
    return button


def _popup(bar: QToolBar, actions: Actions, name: str) -> QToolButton:
    """Return a button that opens the menu `name`."""
    button = QToolButton(bar)
    button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
    menu = QMenu(button)
    menu.addActions([action for action in actions.in_menu(name) if action is not None])
    button.setMenu(menu)
    return button
