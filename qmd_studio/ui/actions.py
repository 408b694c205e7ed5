"""Every verb of the window in one table, which feeds the menus, the tool bar and the list of shortcuts."""

# ruff: noqa: E501  - a row of the table stays on its line

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QCoreApplication, QObject, Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QWidget

from qmd_studio.ui.icons import icon


class Needs(StrEnum):
    """What must be there for a verb to be of use."""

    NOTHING = "nothing"
    CLIP = "clip"
    FRAMES = "more than one frame"
    SELECTION = "a selected joint"
    AVATAR = "a body other than the clip's own"
    DECODED = "a decoded motion"
    UNDO = "a step to take back"
    REDO = "a step taken back"


@dataclass(frozen=True, slots=True)
class Verb:
    """One verb: `id` for the code, `text` with its & for the menu `menu`, the first of `keys` shown beside it.

    `section` parts a menu by separators. Verbs with the same `choice` are alternatives, one of which is on.
    """

    id: str
    text: str
    menu: str
    section: int
    tip: str
    keys: tuple[str, ...] = ()
    icon: str = ""
    needs: Needs = Needs.NOTHING
    checkable: bool = False
    choice: str = ""


_C, _F, _D = Needs.CLIP, Needs.FRAMES, Needs.DECODED

VERBS: tuple[Verb, ...] = (
    Verb("open", "&Open…", "file", 1, "Open motions or bodies; files can also be dropped on the window", ("Ctrl+O",), "open"),
    Verb("export_qmd", "&Export QMD", "file", 2, "Write the very bytes that were measured to a QMD file", ("Ctrl+E",), "export", _C),
    Verb("export_as", "Export &as…", "file", 2, "Write the shown clip to a file of any format that can hold it", ("Ctrl+Shift+E",), "", _C),
    Verb("close_clip", "&Close clip", "file", 3, "Close the shown clip; undo brings it back", ("Ctrl+W",), "", _C),
    Verb("quit", "&Quit", "file", 4, "Leave the studio; the layout is remembered", ("Ctrl+Q",)),
    Verb("undo", "&Undo", "edit", 1, "Take back the last change", ("Ctrl+Z",), "undo", Needs.UNDO),
    Verb("redo", "&Redo", "edit", 1, "Do the change that was taken back again", ("Ctrl+Shift+Z", "Ctrl+Y"), "redo", Needs.REDO),
    Verb("rename_clip", "Re&name clip", "edit", 2, "Give the shown clip another name", ("F2",), "", _C),
    Verb("dismiss", "&Dismiss message", "edit", 3, "Close the newest message in the window", ("Esc",)),
    Verb("frame_all", "Frame &all", "view", 1, "Move the camera so that the whole body is seen", ("Shift+F",), "frame-all"),
    Verb("frame_selection", "Frame &selection", "view", 1, "Move the camera to the selected joint", ("F",), "frame-selection", Needs.SELECTION),
    Verb("follow", "Fo&llow body", "view", 1, "Let the camera go along with the body", ("Ctrl+F",), "", _C, True),
    Verb("view_front", "Fr&ont", "view_from", 1, "Look from the front", ("1",)),
    Verb("view_back", "&Back", "view_from", 1, "Look from behind", ("Ctrl+1",)),
    Verb("view_left", "&Left side", "view_from", 1, "Look at the left side", ("3",)),
    Verb("view_right", "&Right side", "view_from", 1, "Look at the right side", ("Ctrl+3",)),
    Verb("view_top", "&Top", "view_from", 1, "Look from above", ("7",)),
    Verb("view_three_quarter", "Three-&quarter", "view_from", 1, "Look from the front, a little to the side and above", ("0",)),
    Verb("orthographic", "&Parallel projection", "view_from", 2, "Change between perspective and parallel projection", ("5",)),
    Verb("look_solid", "&Solid", "look", 1, "Show bodies in their own colours", (), "look-solid", Needs.NOTHING, True, "look"),
    Verb("look_segments", "Se&gments", "look", 1, "Show the skin of each joint in a colour of its own", (), "look-segments", Needs.NOTHING, True, "look"),
    Verb("look_xray", "&X-ray", "look", 1, "See through the skin: joints as dots, bones as lines", (), "look-xray", Needs.NOTHING, True, "look"),
    Verb("look_wire", "&Wireframe", "look", 1, "Show the edges of the triangles", (), "look-wire", Needs.NOTHING, True, "look"),
    Verb("joint_names", "&Joint names", "look", 2, "Name the joint under the mouse, and its segment", (), "", Needs.NOTHING, True),
    Verb("show_original", "S&ide A", "view", 2, "Show side A: the motion as it is, or the encoding that B is compared with", ("Alt+1",), "original", _C, True, "overlay"),
    Verb("show_both", "A a&nd B", "view", 2, "Show both sides, in the way chosen under Compare by", ("Alt+2",), "both", _D, True, "overlay"),
    Verb("show_decoded", "Side &B", "view", 2, "Show side B: what the QMD file plays", ("Alt+3",), "decoded", _D, True, "overlay"),
    Verb("heat_map", "&Heat map", "view", 3, "Paint the error of each joint on the body", ("E",), "heat", _D, True),
    Verb("compare_wipe", "&Wipe", "compare", 1, "A left of a line, B right of it", (), "", _D, True, "compare"),
    Verb("compare_beside", "&Beside each other", "compare", 1, "A and B beside each other, seen by one camera", (), "", _D, True, "compare"),
    Verb("compare_ghost", "&Ghost", "compare", 1, "B as a ghost over A", (), "", _D, True, "compare"),
    Verb("compare_difference", "&Difference", "compare", 1, "Only what of B is not where it is in A, coloured by how far it is off", (), "", _D, True, "compare"),
    Verb("theme_system", "&System", "theme", 1, "Light or dark as the system is", (), "", Needs.NOTHING, True, "theme"),
    Verb("theme_light", "&Light", "theme", 1, "Always light", (), "", Needs.NOTHING, True, "theme"),
    Verb("theme_dark", "&Dark", "theme", 1, "Always dark", (), "", Needs.NOTHING, True, "theme"),
    Verb("full_screen", "F&ull screen", "view", 4, "Use the whole screen, or go back to a window", ("F11",)),
    Verb("reset_layout", "&Reset layout", "view", 4, "Put every panel back where it was at first"),
    Verb("play", "&Play", "animate", 1, "Play or pause", ("Space",), "play", _F),
    Verb("play_reverse", "Play in re&verse", "animate", 1, "Play backwards or pause", ("Ctrl+Shift+Space",), "reverse", _F),
    Verb("previous_frame", "Prev&ious frame", "animate", 2, "Back one frame", ("Left",), "previous", _F),
    Verb("next_frame", "&Next frame", "animate", 2, "On one frame", ("Right",), "next", _F),
    Verb("back_second", "&Back one second", "animate", 2, "Back one second", ("Ctrl+Left",), "", _F),
    Verb("on_second", "On one secon&d", "animate", 2, "On one second", ("Ctrl+Right",), "", _F),
    Verb("first_frame", "&First frame", "animate", 2, "To the first frame", ("Home", "Shift+Left"), "first", _F),
    Verb("last_frame", "&Last frame", "animate", 2, "To the last frame", ("End", "Shift+Right"), "last", _F),
    Verb("go_to", "Go &to…", "animate", 2, "Type a frame (123), seconds (4.1s) or a time (0:04.1)", ("Ctrl+G",), "", _F),
    Verb("next_worst", "Next &worst frame", "animate", 3, "To the next of the frames where the decoded motion strays most", ("N",), "", _D),
    Verb("previous_worst", "Previo&us worst frame", "animate", 3, "Back to the last of the frames where the decoded motion strays most", ("Shift+N",), "", _D),
    Verb("loop", "L&oop", "animate", 4, "Start again at the end", ("Ctrl+L",), "loop", _F, True),
    Verb("range_start", "Range &starts here", "animate", 5, "Play from the shown frame on", ("P",), "", _F),
    Verb("range_end", "Range &ends here", "animate", 5, "Play up to the shown frame", ("Shift+P",), "", _F),
    Verb("range_clear", "&Clear range", "animate", 5, "Play the whole clip again", ("Alt+P",), "", _F),
    Verb("slower", "Slowe&r", "animate", 6, "Halve the speed, to a tenth at most", ("Ctrl+Down",), "", _F),
    Verb("faster", "F&aster", "animate", 6, "Double the speed, to four times at most", ("Ctrl+Up",), "", _F),
    Verb("wear_default", "&Default avatar", "body", 1, "Show the clip on the avatar that the studio starts with", (), "body", _C),
    Verb("wear_bones", "Made from &bones", "body", 1, "Show the clip on a body made from its own bones", (), "", _C),
    Verb("wear_file", "Body from a &file…", "body", 1, "Show the clip on the body of an H-Anim or GLB file", (), "", _C),
    Verb("joint_map", "&Joint map…", "body", 2, "See and edit which joint of the motion moves which of the body", (), "", Needs.AVATAR),
    Verb("bake", "Ba&ke onto the body", "body", 2, "Make a new clip of the motion as the body makes it, in body animation parameters", (), "", Needs.AVATAR),
    Verb("reset_codec", "&Reset settings", "compress", 2, "Set FDF, b, n_d and the encoder back to what they were at first", (), "", _C),
    Verb("encoder_closed", "&Closed loop", "encoder", 1, "The indices of a frame together put the joints where they were", (), "", _C, True, "encoder"),
    Verb("encoder_plain", "P&lain loop", "encoder", 1, "Each index makes up for its own column's error so far", (), "", _C, True, "encoder"),
    Verb("encoder_paper", "&Paper", "encoder", 1, "Each index as the paper chooses it: errors add up", (), "", _C, True, "encoder"),
    Verb("encoder_bounded", "&Bounded", "encoder", 1, "Every joint within a distance, in the fewest bytes that do", (), "", _C, True, "encoder"),
    Verb("encoder_compact", "Co&mpact profile", "encoder", 2, "Version 2 of the format: made for an error, several times smaller", (), "", _C, True, "encoder"),
    Verb("column_levels", "Column &levels…", "compress", 3, "Read and edit the level of each column, which the paper's encoder goes by", (), "", _C),
    Verb("help", "&Contents", "help", 1, "How the studio is used, and the QMD format byte by byte", ("F1",), "help"),
    Verb("shortcuts", "&Keyboard shortcuts", "help", 1, "All keys in one list", ("Ctrl+/",)),
    Verb("about", "&About QMD Studio", "help", 2, "Version, licence and what the studio runs on"),
)  # fmt: skip

REPEATING = {"previous_frame", "next_frame", "back_second", "on_second", "undo", "redo"}
"""Verbs that go on while their key is held down."""


class Actions(QObject):
    """The table as `QAction`s of one window; `actions["play"]` is the action of that verb."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._actions: dict[str, QAction] = {}
        self._groups: dict[str, QActionGroup] = {}
        for verb in VERBS:
            action = QAction(translated(verb.text), window)
            action.setObjectName(verb.id)
            action.setShortcuts([QKeySequence(key) for key in verb.keys])
            action.setShortcutContext(Qt.ShortcutContext.WindowShortcut)
            action.setAutoRepeat(verb.id in REPEATING)
            action.setCheckable(verb.checkable)
            action.setStatusTip(translated(verb.tip))
            action.setToolTip(tip_of(verb))
            if verb.choice:
                self._groups.setdefault(verb.choice, QActionGroup(self)).addAction(action)
            window.addAction(action)
            self._actions[verb.id] = action
        self.refresh_icons()

    def __getitem__(self, verb_id: str) -> QAction:
        return self._actions[verb_id]

    def connect_all(self, handlers: Mapping[str, Callable[[], object]]) -> None:
        """Connect each verb to its handler; raises `KeyError` where a verb has none or a handler no verb."""
        if missing := self._actions.keys() ^ handlers.keys():
            raise KeyError(f"verbs and handlers differ: {sorted(missing)}")
        for verb_id, handler in handlers.items():
            self._actions[verb_id].triggered.connect(lambda _checked=False, handler=handler: handler())

    def refresh_icons(self) -> None:
        """Draw the icons in the colours of the present theme."""
        for verb in VERBS:
            if verb.icon:
                self._actions[verb.id].setIcon(icon(verb.icon))

    def enable(self, present: set[Needs]) -> None:
        """Enable the verbs whose needs are `present`."""
        for verb in VERBS:
            self._actions[verb.id].setEnabled(verb.needs is Needs.NOTHING or verb.needs in present)

    def in_menu(self, menu: str) -> list[QAction | None]:
        """Return the actions of `menu` in order, None standing for a separator."""
        result: list[QAction | None] = []
        section = None
        for verb in VERBS:
            if verb.menu == menu:
                if section not in (None, verb.section):
                    result.append(None)
                section = verb.section
                result.append(self._actions[verb.id])
        return result


def translated(text: str) -> str:
    """Return a text of the table in the user's language."""
    return QCoreApplication.translate("Actions", text)


def plain_text(verb: Verb) -> str:
    """Return the verb's text without its mnemonic."""
    return translated(verb.text).replace("&", "")


def keys_text(verb: Verb) -> str:
    """Return the verb's keys as the platform writes them."""
    native = QKeySequence.SequenceFormat.NativeText
    return ", ".join(QKeySequence(key).toString(native) for key in verb.keys)


def tip_of(verb: Verb) -> str:
    """Return the verb's tool tip, its keys at the end."""
    keys = keys_text(verb)
    return translated(verb.tip) + (f"  ({keys})" if keys else "")
