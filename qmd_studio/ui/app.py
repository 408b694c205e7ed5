"""The studio's entry: options, the application, its window, and what happens to a fault that nobody foresaw."""

from __future__ import annotations

import argparse
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from PySide6.QtCore import QCoreApplication, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QFont, QFontDatabase, QGuiApplication, QSurfaceFormat
from PySide6.QtWidgets import QApplication

from qmd_studio import __version__
from qmd_studio.errors import QmdStudioError
from qmd_studio.ui.collector import Collector
from qmd_studio.ui.icons import application_icon
from qmd_studio.ui.keys import KeyGuard
from qmd_studio.ui.main_window import MainWindow
from qmd_studio.ui.settings import ORGANISATION, Settings
from qmd_studio.ui.theme import Theme, ThemeSwitch
from qmd_studio.ui.viewport_format import viewport_format

INTERRUPT_POLL_MS = 300
SWITCH_S = 0.0005
"""A thread in the interpreter lets the window have its turn after this long; Python's own 5 ms add up within one event.

A new frame beside a thread that is busy in Python took 96 ms (one in ten 280 ms) with 5 ms, and 53 ms with this.
Compiled kernels let go of the interpreter anyway.
"""
TIME_FIRST_PAINT = "QMD_STUDIO_TIME_FIRST_PAINT"
"""Where this variable is set, the studio says when its first picture was on the screen, and quits: for benchmarks."""

_log = logging.getLogger(__name__)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the studio and return its exit status: 0, or 2 for wrong usage."""
    options = parser().parse_args(sys.argv[1:] if argv is None else argv)
    logging.basicConfig(format="%(levelname)s %(name)s: %(message)s")
    app = make_application()
    settings = Settings()
    window = MainWindow(settings, ThemeSwitch(app, Theme(settings.theme)))
    faults = report_faults_in(window)
    stop_on_interrupt(app)
    if os.environ.get(TIME_FIRST_PAINT):
        quit_at_first_paint(app, window)
    if options.tour is not None:
        from qmd_studio.ui.tour import Tour

        tour = Tour(window, options.tour, options.files[0] if options.files else None)
        window.show()
        tour.start()
        app.exec()
        faults.stop()
        return tour.status
    if options.files:
        window.when_furnished(lambda: window.open_paths(options.files))
    elif options.sample:
        window.when_furnished(window.files.open_sample)
    window.show()
    status = app.exec()
    faults.stop()
    return status


def quit_at_first_paint(app: QApplication, window: MainWindow) -> None:
    """Print the milliseconds from here to the viewport's first picture on the screen, then end the application."""
    start = time.perf_counter()

    def tell() -> None:
        print(f"first paint: {1000 * (time.perf_counter() - start):.0f} ms", flush=True)
        app.exit()

    window.viewport.frameSwapped.connect(tell, Qt.ConnectionType.SingleShotConnection)


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    result = argparse.ArgumentParser(prog="qmd-studio", description="Open the studio for avatar animation.")
    result.add_argument("files", nargs="*", type=Path, metavar="FILE", help="a motion or body to open")
    result.add_argument("--no-sample", dest="sample", action="store_false", help="start without the sample motion")
    result.add_argument(
        "--tour",
        type=Path,
        metavar="OUT",
        help="open, tune, export QMD and reopen by itself, leave pictures and the file in the folder OUT, and quit",
    )
    result.add_argument("--version", action="version", version=f"QMD Studio {__version__}")
    return result


def make_application() -> QApplication:
    """Return the application, its OpenGL format set before it as Qt demands, its names, font and keys set up."""
    sys.setswitchinterval(SWITCH_S)
    QSurfaceFormat.setDefaultFormat(viewport_format())
    QGuiApplication.setHighDpiScaleFactorRoundingPolicy(Qt.HighDpiScaleFactorRoundingPolicy.PassThrough)
    app = QApplication.instance() or QApplication(["qmd-studio"])
    QCoreApplication.setOrganizationName(ORGANISATION)
    QCoreApplication.setApplicationName("QMD Studio")
    QCoreApplication.setApplicationVersion(__version__)
    QGuiApplication.setDesktopFileName("qmd-studio")
    app.setWindowIcon(application_icon())
    app.setFont(_font())
    app.key_guard = KeyGuard(app)
    app.collector = Collector(app)
    return app


def _font() -> QFont:
    font = QFontDatabase.systemFont(QFontDatabase.SystemFont.GeneralFont)
    if hasattr(QFont, "Tag"):
        font.setFeature(QFont.Tag("tnum"), 1)  # figures of one width: numbers that run do not dance
    return font


class FaultReporter(QObject):
    """Shows exceptions that nobody caught, from whatever thread, as a message in the window, and logs them."""

    _raised = Signal(object)

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._before = (sys.excepthook, threading.excepthook)
        self._raised.connect(window.show_problem)
        sys.excepthook = self._take
        threading.excepthook = lambda args: self._take(args.exc_type, args.exc_value, args.exc_traceback)

    def stop(self) -> None:
        """Give the hooks back."""
        sys.excepthook, threading.excepthook = self._before

    def _take(self, kind: type[BaseException], problem: BaseException | None, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            QCoreApplication.quit()
            return
        _log.error("uncaught", exc_info=(kind, problem, trace))
        if not isinstance(problem, QmdStudioError):
            hint = "This is a fault of the studio. What is open stays open; the details are on the terminal."
            problem = QmdStudioError(f"something went wrong ({kind.__name__}: {problem})", hint=hint)
        try:
            self._raised.emit(problem)
        except RuntimeError:  # the window has gone
            _log.debug("no window to show it in")


def report_faults_in(window: MainWindow) -> FaultReporter:
    """Show uncaught exceptions in `window` until the returned reporter is stopped."""
    return FaultReporter(window)


def stop_on_interrupt(app: QApplication) -> None:
    """Make Ctrl+C in the terminal close the windows; a slow timer lets Python look at its signals while Qt waits."""
    signal.signal(signal.SIGINT, lambda *_: app.closeAllWindows())
    timer = QTimer(app)
    timer.start(INTERRUPT_POLL_MS)
    timer.timeout.connect(lambda: None)


if __name__ == "__main__":
    sys.exit(main())
