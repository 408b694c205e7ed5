"""The docks around the viewport, and the layout they have at first."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtWidgets import QDockWidget, QFrame, QMainWindow, QScrollArea, QWidget

from qmd_studio.ui.dock_title import DockTitle

OUTLINER_WIDTH = 240
LAB_WIDTH, LAB_MIN_WIDTH = 360, 340


def dock(window: QMainWindow, name: str, title: str, content: QWidget) -> QDockWidget:
    """Return a dock called `name` in saved layouts; the caller adds it where it belongs."""
    result = QDockWidget(title, window)
    result.setObjectName(name)
    result.setWidget(content)
    result.setTitleBarWidget(DockTitle(result))
    result.setFeatures(
        QDockWidget.DockWidgetFeature.DockWidgetMovable
        | QDockWidget.DockWidgetFeature.DockWidgetFloatable
        | QDockWidget.DockWidgetFeature.DockWidgetClosable
    )
    action = result.toggleViewAction()
    action.setToolTip(QCoreApplication.translate("Panels", "Show or hide this panel"))
    return result


def scrolling(content: QWidget) -> QScrollArea:
    """Return `content` in an area that scrolls up and down where the window is low."""
    area = QScrollArea()
    area.setWidget(content)
    area.setMinimumWidth(content.minimumSizeHint().width())
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    return area


def arrange(window: QMainWindow, outliner: QDockWidget, below: tuple[QDockWidget, ...], lab: QDockWidget) -> None:
    """Put the docks where they are at first: outliner over those `below` it on the left, the lab on the right."""
    left, right = Qt.DockWidgetArea.LeftDockWidgetArea, Qt.DockWidgetArea.RightDockWidgetArea
    clip, *others = below
    for panel, area in ((outliner, left), *((panel, left) for panel in below), (lab, right)):
        panel.setFloating(False)
        window.addDockWidget(area, panel)
        panel.show()
    window.splitDockWidget(outliner, clip, Qt.Orientation.Vertical)
    for panel in others:
        window.tabifyDockWidget(clip, panel)
    clip.raise_()
    window.resizeDocks([outliner, lab], [OUTLINER_WIDTH, LAB_WIDTH], Qt.Orientation.Horizontal)
    window.resizeDocks([outliner, clip], [400, 300], Qt.Orientation.Vertical)
