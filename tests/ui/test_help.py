"""The help as it is read: every page is linked from the first, links lead there, and pictures are seen."""

import re

from PySide6.QtCore import QUrl
from PySide6.QtGui import QTextDocument

from qmd_studio import assets
from qmd_studio.ui.help_dialog import HelpDialog


def test_every_page_is_linked_from_the_first_and_links_lead_there(window):
    pages = {path.name for path in assets.resource("help").glob("*.md")}
    linked = set(re.findall(r"\]\(([\w-]+\.md)\)", assets.resource("help", "index.md").read_text(encoding="utf-8")))
    assert linked == pages - {"index.md"}
    dialog = HelpDialog(window)
    for page in sorted(linked):
        dialog.contents.setCurrentRow(0)
        dialog.page.anchorClicked.emit(QUrl(page))
        title = assets.resource("help", page).read_text(encoding="utf-8").splitlines()[0].lstrip("# ")
        assert dialog.contents.currentItem().text() == title
        assert dialog.page.toPlainText().startswith(title)
    dialog.deleteLater()


def test_pictures_of_a_page_are_found_and_fit(window):
    dialog = HelpDialog(window)
    dialog.page.anchorClicked.emit(QUrl("bap.md"))
    kind = QTextDocument.ResourceType.ImageResource.value
    picture = dialog.page.loadResource(kind, QUrl("bap-poses.png"))
    assert 100 < picture.width() / picture.devicePixelRatio() <= 600
    dialog.deleteLater()
