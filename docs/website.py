"""Builds the documentation as a static site: ``make docs``; needs ``stepbot[docs]`` and no network.

Pages keep their paths, so that links between ``docs/``, ``robot_library/`` and the files beside them work as they do on
a code host. A link or anchor that leads nowhere fails the build. The pictures of the library open the reports of its
robots, if ``make docs REPORTS=1`` has converted them.
"""

import json
import logging
import re
import shutil
import sys
from pathlib import Path

from mkdocs.commands.build import build
from mkdocs.config import load_config

ROOT = Path(__file__).parents[1]
PAGES, SITE, REPORTS = (ROOT / "build" / name for name in ("pages", "site", "reports"))
TOP = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "LICENSE")
NAV = {
    "Learn": ("first-hour", "authoring", "view"),
    "Do": ("use-it-in", "convert-from", "drive", "collision", "revisions", "compose", "api"),
    "Look up": ("sidecar", "commands", "diagnostics", "mapping", "reading"),
    "Why": ("verification", "architecture"),
}
"""Sections and pages, in the order of docs/README.md."""
_WORKER = "iframe-worker.js"
_LOADED = re.compile(r"<(?:script|img|link rel=.?stylesheet)[^>]+(?:src|href)=.?https?:")
"""A script, picture or style of another host."""
_CODE = re.compile(r"\[([^\]]+)\]\([\w./-]+\.py\)")
"""A link to a module, which the site does not have."""
_FOLDER = re.compile(r"(\]\(|href=\")([\w./-]+?)/?(?=\)|\")")


def staged() -> None:
    """Copy what the site shows to :data:`PAGES`; links to folders lead to their page or list of files."""
    shutil.rmtree(PAGES, ignore_errors=True)
    for name in TOP:
        _copy(ROOT / name)
    for kind in ("docs/*.md", "docs/decisions/*.md", "docs/pictures/*.*", "benchmarks/*.md", "robot_library/*.md"):
        for path in ROOT.glob(kind):
            if path.suffix != ".py":
                _copy(path)
    for kind in ("README.md", "preview.png", "drive.svg", "*.robot.yaml", "*.step"):
        for path in ROOT.glob(f"robot_library/*/{kind}"):
            _copy(path)
    for path in ROOT.glob("robot_library/composed/*.png"):
        _copy(path)
    for path in (ROOT / "schemas").rglob("*.json"):
        _copy(path)
    decisions = sorted((ROOT / "docs" / "decisions").glob("*.md"))
    titles = [(path.name, path.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")) for path in decisions]
    listed = "\n".join(f"- [{title}]({name})" for name, title in titles)
    (PAGES / "docs" / "decisions" / "README.md").write_text(f"# Decisions\n\n{listed}\n", encoding="utf-8")
    for page in PAGES.rglob("*.md"):
        page.write_text(_with_pages(page), encoding="utf-8", newline="\n")


def _copy(path: Path) -> None:
    target = PAGES / path.relative_to(ROOT)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(path, target)


def _with_pages(page: Path) -> str:
    """The text of a page whose links to folders name the page in them, and pictures of robots their report."""

    def named(link: re.Match[str]) -> str:
        target = page.parent / link[2]
        report = REPORTS / target.name / "report.html"
        if link[1].startswith("href") and report.is_file():
            return f"{link[1]}{'../' * len(page.parent.relative_to(PAGES).parts)}reports/{target.name}.html"
        index = f"{link[1]}{link[2]}/README.md"
        if link[1].startswith("href"):
            index = index.replace("README.md", "index.html")  # HTML is not rewritten by mkdocs
        return index if (target / "README.md").is_file() else link[0]

    text = _CODE.sub(r"\1", page.read_text(encoding="utf-8"))
    return _FOLDER.sub(named, text)


def config() -> dict[str, object]:
    """The configuration of mkdocs; nothing in it refers to the network."""
    sections = [{title: [f"docs/{name}.md" for name in names]} for title, names in NAV.items()]
    nav = [{"stepbot": "README.md"}, {"Map": "docs/README.md"}, *sections, {"Library": "robot_library/README.md"}]
    return {
        "site_name": "stepbot",
        "docs_dir": str(PAGES),
        "site_dir": str(SITE),
        "use_directory_urls": False,
        "strict": True,
        "nav": [*nav, {"Decisions": "docs/decisions/README.md"}, {"Changes": "CHANGELOG.md"}],
        "theme": {
            "name": "material",
            "font": False,
            "features": ["navigation.tabs", "toc.follow", "content.code.copy"],
        },
        "plugins": ["search", "offline"],
        "markdown_extensions": ["tables", "attr_list", "md_in_html", {"toc": {"permalink": True}}],
        "validation": {"omitted_files": "ignore", "unrecognized_links": "warn", "anchors": "warn"},
    }


def _bring_search() -> None:
    """Let pages load the worker of the search from the site; the theme names a host for pages opened as files."""
    shutil.copy(Path(__file__).with_name(_WORKER), SITE / "assets" / "javascripts" / _WORKER)
    for page in SITE.rglob("*.html"):
        up = "../" * (len(page.relative_to(SITE).parts) - 1)
        text = page.read_text(encoding="utf-8")
        local = text.replace("https://unpkg.com/iframe-worker/shim", f"{up}assets/javascripts/{_WORKER}")
        page.write_text(local, encoding="utf-8", newline="\n")


def main() -> int:
    """Build the site; returns the exit code."""
    logging.basicConfig(level=logging.WARNING, format="%(message)s")
    staged()
    written = ROOT / "build" / "mkdocs.yml"
    written.write_text(json.dumps(config()), encoding="utf-8")  # JSON is YAML
    build(load_config(str(written)))
    for report in REPORTS.glob("*/report.html"):
        (SITE / "reports").mkdir(exist_ok=True)
        shutil.copy(report, SITE / "reports" / f"{report.parent.name}.html")
    _bring_search()
    outside = [path for path in SITE.rglob("*.html") if _LOADED.search(path.read_text(encoding="utf-8"))]
    for path in outside[:5]:
        print(f"{path.relative_to(ROOT)}: loads a file from the network")
    return int(bool(outside))


if __name__ == "__main__":
    sys.exit(main())
