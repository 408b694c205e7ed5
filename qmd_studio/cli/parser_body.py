"""The grammar of `qmd body`: verbs for avatars."""

from __future__ import annotations

from typing import Any

from qmd_studio.cli.grammar import Parser, above_zero, add_verb


def add_body(verbs: Any) -> None:
    """Add `body` with its own verbs."""
    summary = "look at a body and write it in another format"
    parser = verbs.add_parser("body", help=summary, description=summary[0].upper() + summary[1:] + ".")
    inner = parser.add_subparsers(dest="body_verb", metavar="VERB", required=True, parser_class=Parser)
    info = add_verb(
        inner, "info", "say what a body consists of, and which rules of H-Anim its file breaks", "body_info"
    )
    info.add_argument("file", metavar="FILE")
    _add_unit(info)
    convert = add_verb(inner, "convert", "write a body and its motion in the format of OUT's suffix", "body_convert")
    convert.add_argument("input", metavar="IN")
    convert.add_argument("output", metavar="OUT", help="a name that ends in .x3d, .x3dv, .wrl or .glb, or packed .x3dz")
    convert.add_argument(
        "--motion",
        choices=("frames", "interpolators", "none"),
        default="frames",
        help="write the motion as frames of H-Anim (the default), as interpolators, or not at all",
    )
    _add_unit(convert)


def _add_unit(parser: Any) -> None:
    parser.add_argument(
        "--metres-per-unit", metavar="M", type=above_zero("--metres-per-unit"), help="the length unit of the file"
    )
