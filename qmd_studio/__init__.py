"""QMD Studio: avatar animation that is small to send and cheap to play."""

__version__ = "0.1.0"
