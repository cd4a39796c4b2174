"""What the comments of the Rust code say, on pages of the site: each definition stands in one place, beside what computes it.

```{rust-header} crates/coapt/src/energy/bending.rs
```

is the head comment of a file;

```{rust-item} crates/coapt/src/measure/annulus.rs AnnulusMeasures
```

what is said of a public item, with its public fields.
"""

import re
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

REFERENCE = re.compile(r"\[(`[^`]+`)\](?!\()")
FIELD = re.compile(r"\s*pub (\w+): ")


class RustDirective(SphinxDirective):
    """Text of a Rust file, which the page then depends on."""

    def lines(self) -> list[str]:
        path = Path(self.env.srcdir).parent / self.arguments[0]
        self.env.note_dependency(str(path))
        return path.read_text(encoding="utf-8").splitlines()

    def told(self, text: str) -> list[nodes.Node]:
        source = f"*In the code:* `{self.arguments[0]}`"
        return self.parse_text_to_nodes(f"{REFERENCE.sub(lambda name: name[1], text)}\n\n{source}\n")


class RustHeader(RustDirective):
    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        header = [line for line in self.lines() if line.startswith("//!")]
        if not header:
            raise self.error(f"{self.arguments[0]} has no head comment")
        return self.told(_uncommented(header))


class RustItem(RustDirective):
    required_arguments = 2

    def run(self) -> list[nodes.Node]:
        lines, name = self.lines(), self.arguments[1]
        declared = re.compile(rf"pub (struct|enum|fn|const) {re.escape(name)}\b")
        at = next((number for number, line in enumerate(lines) if declared.match(line)), None)
        if at is None or not (told := _comment_above(lines, at)):
            raise self.error(f"{self.arguments[0]} has no public `{name}` with a comment")
        fields = _fields(lines, at) if " struct " in lines[at] else []
        items = [f"* **`{field}`**: {meaning}" for field, meaning in fields]
        return self.told("\n".join([told, "", *items]))


def _uncommented(lines: list[str]) -> str:
    return "\n".join(re.sub(r"^\s*//[/!] ?", "", line) for line in lines)


def _comment_above(lines: list[str], at: int) -> str:
    """The comment that ends above a line, or above its attributes."""
    while lines[at - 1].strip().startswith("#["):
        at -= 1
    first = at
    while lines[first - 1].strip().startswith("///"):
        first -= 1
    return _uncommented(lines[first:at])


def _fields(lines: list[str], at: int) -> list[tuple[str, str]]:
    """Public fields with what is said of them, in one line each."""
    found = []
    for number in range(at + 1, len(lines)):
        if lines[number] == "}":
            break
        if field := FIELD.match(lines[number]):
            found.append((field[1], _comment_above(lines, number).replace("\n", " ")))
    return found


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("rust-header", RustHeader)
    app.add_directive("rust-item", RustItem)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
