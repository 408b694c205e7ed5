"""The words of `qmd retarget`."""

from __future__ import annotations

from argparse import Action, ArgumentParser, Namespace
from collections.abc import Sequence
from typing import Any

from qmd_studio.cli.grammar import MAX_COUNT, add_skeleton, add_verb, bad_value, frame_rate, whole


def add_retarget(verbs: Any) -> None:
    """Add `qmd retarget MOTION OUT`."""
    parser = add_verb(verbs, "retarget", "play a motion on another body, whatever its joints are called")
    parser.add_argument("input", metavar="MOTION")
    parser.add_argument("output", metavar="OUT", help="a name that ends in .bap, .bvh, .csv, .npz, …")
    add_skeleton(parser)
    parser.add_argument(
        "--body", metavar="AVATAR", help="a body or skeleton file, or the name of an avatar that ships (the BAP body)"
    )
    parser.add_argument("--map", metavar="FILE", help="which joint moves which, as --save-map writes it; or cmu-62")
    parser.add_argument("--save-map", metavar="FILE", help="write which joint moves which, to be edited")
    parser.add_argument(
        "--align",
        metavar="rest|frame N|zero",
        nargs="+",
        action=_Align,
        help="the pose of MOTION that is the body's rest; zero: take the turns as they stand (what suits the file)",
    )
    parser.add_argument(
        "--limits",
        choices=("report", "keep"),
        default="report",
        help="anatomical limits: say what lies outside, or bring it back (report)",
    )
    parser.add_argument("--pin-feet", action="store_true", help="let feet that stand not slide")
    parser.add_argument("--fps", metavar="F", type=frame_rate, help="frames a second of OUT (as in MOTION)")


class _Align(Action):
    """Reads `rest`, `zero` and `frame N`, N from 0, as the frame's number, "rest" or "zero"."""

    def __call__(
        self,
        parser: ArgumentParser,
        namespace: Namespace,
        values: str | Sequence[Any] | None,
        option: str | None = None,
    ) -> None:
        words = tuple(values or ())
        if words in (("rest",), ("zero",)):
            setattr(namespace, self.dest, words[0])
        elif len(words) == 2 and words[0] == "frame":
            setattr(namespace, self.dest, whole("--align frame", 0, MAX_COUNT)(words[1]))
        else:
            raise bad_value("--align", "rest, zero, or frame and its number", " ".join(map(str, words)))
