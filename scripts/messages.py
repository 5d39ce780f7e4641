"""Every text of the program that a user may read, in one list: file, line, kind and the text itself.

python scripts/messages.py [--kind KIND] [FILE ...]

Kinds: refusal (fields of errors), figure (meanings of results), key (descriptions of design keys), option and command (help),
label (plots, scenes, report page), file (comments in STEP, DXF, SVG and finite-element files), message (warnings, verdicts, tables,
and every other text); docstring and readme are listed on request only. Texts are found in the syntax tree: `{...}`
stands for what the program fills in.
"""

from __future__ import annotations

import argparse
import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "gearmesh"
#: kinds that are listed by default, and kinds that are listed on request only
KINDS = ("refusal", "figure", "key", "option", "command", "label", "file", "message")
DOCUMENTS = ("docstring", "readme")
#: kinds of the texts that are arguments of these functions
CALLS = {
    "figure": "figure",
    "Key": "key",
    "Option": "option",
    "option": "option",
    "Argument": "option",
    "conflict": "refusal",
}
#: module whose functions make keys of a design: `keys.length(...)`
KEYS_MODULE = "keys"
#: kinds of all other texts, by folder of the package
FOLDERS = {"view": "label", "cad": "file", "io": "file", "fe/decks": "file"}
#: fields of a refusal that are texts even if they are one word
FIELDS = {"reason", "allowed", "must_be", "remedy"}
#: two words with a blank between them make a text
SENTENCE = re.compile(r"[A-Za-z}][,;:]? \(?[A-Za-z{]")
#: texts in the report page's own files
PAGE = {
    ".html": re.compile(r">\s*([^<>{}]*[A-Za-z][^<>{}]*?)\s*<|\"([^\"\n]*)\""),
    ".js": re.compile(r"\"([^\"\n]*)\"|`([^`\n]*)`"),
}


@dataclass(frozen=True)
class Text:
    """A text with its file, line and kind; `field`: the argument whose value it is, if any."""

    file: str
    line: int
    kind: str
    field: str
    text: str

    def __str__(self) -> str:
        kind = f"{self.kind}.{self.field}" if self.field else self.kind
        return f"{self.file}:{self.line}: {kind}: {' '.join(self.text.split())}"


def texts(files: Iterable[Path] = (), kinds: Iterable[str] = KINDS) -> list[Text]:
    """Return the texts of these kinds in `files`; by default in the whole package, its READMEs and the other pages."""
    wanted = set(kinds)
    found = (text for file in (list(files) or sources()) for text in _of_file(file))
    return [text for text in found if text.kind in wanted]


def sources() -> list[Path]:
    """All files with texts: the package, the page, the READMEs, guides and pages of the site."""
    own = [path for end in ("py", "md", "html") for path in PACKAGE.rglob(f"*.{end}")]
    page = [PACKAGE / "view" / "report" / name for name in ("scene.js", "view.js")]
    page += sorted((PACKAGE / "explore" / "page").glob("*.js"))
    beside = [ROOT / "README.md", ROOT / "samples" / "README.md", ROOT / "scripts" / "README.md"]
    pages = [path for folder in ("samples/guides", "scripts/site/pages") for path in (ROOT / folder).rglob("*.md")]
    return sorted((*own, *page)) + beside + sorted(pages)


def _of_file(path: Path) -> Iterator[Text]:
    name, source = path.resolve().relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        yield from found_in(name, source)
    elif path.suffix == ".md":
        yield from (Text(name, k, "readme", "", line) for k, line in enumerate(source.splitlines(), 1) if line.strip())
    else:
        for match in PAGE[path.suffix].finditer(source):
            text = next(group for group in match.groups() if group is not None)
            if SENTENCE.search(text):
                yield Text(name, source.count("\n", 0, match.start()) + 1, "label", "", text)


def found_in(file: str, source: str) -> Iterator[Text]:
    """Return the texts of a module, given by its name and source."""
    return _Finder(file).found(ast.parse(source))


class _Finder:
    """The texts of one module."""

    def __init__(self, file: str) -> None:
        folder = file.removeprefix("gearmesh/")
        self.file, self.commands = file, folder.startswith("app/commands/")
        self.kind = next((kind for start, kind in FOLDERS.items() if folder.startswith(f"{start}/")), "message")

    def found(self, tree: ast.AST, kind: str = "", field: str = "") -> Iterator[Text]:
        """The texts in `tree`, given as `field` of a call that makes them of this kind."""
        if isinstance(tree, ast.Constant | ast.JoinedStr):
            yield from self._text(tree, kind, field)
            return
        body = list(ast.iter_child_nodes(tree))
        if isinstance(tree, ast.Module | ast.ClassDef | ast.FunctionDef) and _is_text(body_of := tree.body[:1]):
            command = self.commands and isinstance(tree, ast.FunctionDef) and not tree.name.startswith("_")
            yield self._made(body_of[0], "command" if command else "docstring", "")
            body.remove(body_of[0])
        elif isinstance(tree, ast.Expr) and isinstance(tree.value, ast.Constant):
            return
        if isinstance(tree, ast.Call):
            kind, field = _kind_of(tree.func) or kind, ""
        for child in body:
            name = (child.arg or "") if isinstance(child, ast.keyword) else field
            yield from self.found(child, kind, name)

    def _text(self, node: ast.Constant | ast.JoinedStr, kind: str, field: str) -> Iterator[Text]:
        text = _written(node)
        if SENTENCE.search(text) or (text and kind == "refusal" and field in FIELDS):
            yield Text(self.file, node.lineno, kind or self.kind, field, text)
        if isinstance(node, ast.JoinedStr):
            # texts that are chosen inside of another
            yield from (
                own
                for part in node.values
                if isinstance(part, ast.FormattedValue)
                for own in self.found(part.value, kind, field)
            )

    def _made(self, node: ast.stmt, kind: str, field: str) -> Text:
        assert isinstance(node, ast.Expr)
        assert isinstance(node.value, ast.Constant)
        return Text(self.file, node.lineno, kind, field, str(node.value.value))


def _is_text(body: list[ast.stmt]) -> bool:
    return bool(
        body
        and isinstance(body[0], ast.Expr)
        and isinstance(body[0].value, ast.Constant)
        and isinstance(body[0].value.value, str)
    )


def _kind_of(function: ast.expr) -> str:
    """Return the kind of the texts given to a function; "" if it is the kind of the place."""
    name = (
        function.attr if isinstance(function, ast.Attribute) else function.id if isinstance(function, ast.Name) else ""
    )
    owner = function.value if isinstance(function, ast.Attribute) else None
    if isinstance(owner, ast.Name) and owner.id == KEYS_MODULE:
        return "key"
    return "refusal" if name.endswith("Error") else CALLS.get(name, "")


def _written(node: ast.Constant | ast.JoinedStr) -> str:
    """A text as it is written, `{...}` for what is filled in."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    parts = (part.value if isinstance(part, ast.Constant) else f"{{{ast.unparse(part.value)}}}" for part in node.values)  # type: ignore[attr-defined]
    return "".join(map(str, parts))


def main() -> None:
    """The list, of the kinds and files that the command line names."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="only these files")
    parser.add_argument("--kind", action="append", choices=KINDS + DOCUMENTS, help="only this kind; may be repeated")
    asked = parser.parse_args()
    for text in texts(asked.files, asked.kind or KINDS):
        print(text)


if __name__ == "__main__":
    main()
