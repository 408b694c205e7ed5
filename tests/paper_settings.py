"""Settings of the lab that are the paper's format and leave nothing out, as most tests want them."""

from qmd_studio.codecs.qmd.settings import QmdSettings
from qmd_studio.tuning.encode_settings import EncodeSettings


def paper(**values):
    """Return the paper's format with these settings."""
    return EncodeSettings(QmdSettings(**values))
