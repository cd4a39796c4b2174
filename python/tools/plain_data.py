"""Writes the classes of repairs, tissues and settings of the Python package from the schemas of scenes and plans.

    python python/tools/plain_data.py

The schemas under assets/schema are made from the types of the library, so that keys, defaults and their documentation stand
in one place. A test runs this and compares; nobody edits what it writes.
"""

from __future__ import annotations

import json
import re
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "src" / "coapt"

PREFIXES = {"ChordLaw": "Chord"}
"""Whose kinds need a word before their names: `Linear` alone would say nothing."""

FILES = {"curve_file"}
"""Keys that name files beside a plan: Python has no such folder, and `coapt.read_curve` reads them."""


def main() -> None:
    for name, text in modules().items():
        (PACKAGE / name).write_text(text, encoding="utf-8")


def modules() -> dict[str, str]:
    """The text of each module, by the name of its file."""
    plan = schema("plan")
    scene = schema("scene")
    return {
        "_repairs.py": module(
            "What is done to a valve, with the keys of plans.", plan, kinds(plan, "Repair"), "Repair"
        ),
        "_tissue.py": module(
            "What leaflets and chordae are made of, with the keys of scenes.",
            scene,
            [("SpringBranches", scene["SpringBranches"]), *kinds(scene, "Tissue"), *kinds(scene, "ChordLaw")],
            "Tissue",
            "ChordLaw",
        ),
        "_settings.py": module(
            "How leaflets touch, where landmarks are and how equilibria are sought, with the keys of scenes.",
            scene,
            [(name, scene[name]) for name in ("Contact", "Landmarks", "Settings", "Weld")],
        ),
    }


def schema(name: str) -> dict[str, dict]:
    path = ROOT / "assets" / "schema" / f"{name}.schema.json"
    return json.loads(path.read_text(encoding="utf-8"))["$defs"]


def kinds(schema: dict[str, dict], name: str) -> list[tuple[str, dict]]:
    """The kinds of a type that a tag tells apart, each with the name of its class."""
    return [(PREFIXES.get(name, "") + class_name(tag(kind)[1]), kind) for kind in schema[name]["oneOf"]]


def tag(kind: dict) -> tuple[str, str]:
    found = [(key, value["const"]) for key, value in kind["properties"].items() if "const" in value]
    return found[0]


def class_name(kebab: str) -> str:
    return "".join(word.capitalize() for word in kebab.split("-"))


def module(about: str, schema: dict[str, dict], classes: list[tuple[str, dict]], *unions: str) -> str:
    body = "\n\n".join(one_class(schema, name, it) for name, it in classes)
    ends = "".join(union(schema, name) for name in unions)
    names = [name for name, _ in classes] + list(unions)
    types = [word for word in ("Curve", "PlainData", "RepairData", "Vector") if re.search(rf"\b{word}\b", body)]
    typing = [word for word in ("ClassVar", "Literal") if word in body] + (["TypeAlias", "Union"] if unions else [])
    exported = "".join(f'    "{name}",\n' for name in sorted(names))
    generic = [word for word in ("Mapping", "Sequence") if f"{word}[" in body]
    collections = f"from collections.abc import {', '.join(generic)}\n" if generic else ""
    return (
        f'"""{about}\n\nWritten by python/tools/plain_data.py from the schemas under assets/schema.\n"""\n\n'
        "from __future__ import annotations\n\n"
        f"{collections}from dataclasses import dataclass\n"
        + (f"from typing import {', '.join(typing)}\n" if typing else "")
        + f"\nfrom coapt._plain import {', '.join(types)}\n\n"
        f"__all__ = [\n{exported}]\n\n\n{body}{ends}"
    )


def union(schema: dict[str, dict], name: str) -> str:
    names = ", ".join(it for it, _ in kinds(schema, name))
    told = textwrap.fill(clean(schema[name]["description"]), 105, initial_indent="#: ", subsequent_indent="#: ")
    return f"\n\n{told}\n{name}: TypeAlias = Union[{names}]\n"


def one_class(schema: dict[str, dict], name: str, it: dict) -> str:
    properties = {key: value for key, value in it["properties"].items() if "const" not in value and key not in FILES}
    required = [key for key in it.get("required", []) if key in properties]
    order = required + [key for key in properties if key not in required]
    lines = ["@dataclass(frozen=True, kw_only=True, slots=True)", f"class {name}({'RepairData' if is_repair(schema, it) else 'PlainData'}):"]
    lines += docstring(schema, it["description"], [(key, properties[key], key in required) for key in order])
    if is_repair(schema, it):
        lines[-1:] = RAISES
    if any("const" in value for value in it["properties"].values()):
        lines += ["", f"    _TAG: ClassVar[tuple[str, str] | None] = {tag(it)}".replace("'", '"')]
    lists = [key for key in order if is_list(python_type(schema, properties[key]))]
    if lists:
        made = ", ".join(f'"{key}"' for key in lists) + ","
        lines += [f"    _LISTS: ClassVar[tuple[str, ...]] = ({made})"]
    shapes = {key: SHAPES[kind] for key in lists if (kind := python_type(schema, properties[key])) in SHAPES}
    if shapes and is_repair(schema, it):
        made = ", ".join(f'"{key}": {shape}' for key, shape in shapes.items())
        lines += [f"    _SHAPES: ClassVar[Mapping[str, tuple[int | None, ...]]] = {{{made}}}"]
    lines += [""]
    for key in order:
        kind = python_type(schema, properties[key])
        lines.append(f"    {key}: {kind}" if key in required else f"    {key}: {kind} | None = None")
    if name == "Ring":
        lines += ring_families(schema, properties)
    return "\n".join(lines) + "\n"


def is_repair(schema: dict[str, dict], it: dict) -> bool:
    return any(it is kind for kind in schema.get("Repair", {}).get("oneOf", []))


SHAPES = {"Curve": "(None, 3)", "Vector": "(3,)"}
"""Shapes of the types that hold coordinates; None is any length."""


def is_list(python_type: str) -> bool:
    return python_type in ("Curve", "Vector") or python_type.startswith("Sequence[")


def ring_families(schema: dict[str, dict], properties: dict[str, dict]) -> list[str]:
    """A constructor for each parametric family."""
    keys = ["ap_mm", "saddle_height_mm", "attachment", "sutures", "flexible"]
    lines = []
    for family in schema["RingFamily"]["oneOf"]:
        name = family["const"]
        lines += ["", "    @classmethod", f"    def {name.replace('-', '_')}(", "        cls,", "        size_mm: float,", "        *,"]
        lines += [f"        {key}: {python_type(schema, properties[key])} | None = None," for key in keys]
        lines += ["    ) -> Ring:"]
        lines += [f'        """{clean(family["description"])} ``size_mm`` is the inner transverse diameter [mm]."""']
        lines += ["        return cls(", f'            family="{name}",', "            size_mm=size_mm,"]
        lines += [f"            {key}={key}," for key in keys] + ["        )"]
    return lines


def docstring(schema: dict[str, dict], about: str, keys: list[tuple[str, dict, bool]]) -> list[str]:
    lines = textwrap.wrap(clean(about), 100) or [""]
    made = ['    """' + lines[0]] + ["    " + line for line in lines[1:]]
    made += ["", "    Parameters", "    ----------"]
    for key, value, is_required in keys:
        optional = "" if is_required else ", optional"
        made.append(f"    {key} : {python_type(schema, value)}{optional}")
        told = clean(value.get("description", ""))
        if value.get("default") not in (None, {}) and not is_required:
            told += f" Default: {json.dumps(value['default'])}."
        made += textwrap.wrap(told, 100, initial_indent=" " * 8, subsequent_indent=" " * 8)
    return made + ['    """']


RAISES = """
    Raises
    ------
    InputError
        A value that a key does not take. Whether it makes sense for a valve is told by what takes it.
    \"\"\"""".splitlines()
"""What a repair tells when it is made."""


def clean(text: str) -> str:
    """Documentation of the library without its links."""
    text = re.sub(r"\[`(?:crate::)?([^`]+)`\]", r"``\1``", text)
    text = re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text)
    return " ".join(text.replace("\\", "\\\\").split())


def python_type(schema: dict[str, dict], value: dict) -> str:
    if "$ref" in value:
        return named(schema, value["$ref"].rsplit("/", 1)[1])
    if "anyOf" in value:
        # Of one value, null, lists and ranges of values, the one value.
        return python_type(schema, value["anyOf"][0])
    kind = value["type"]
    kind = next(it for it in kind if it != "null") if isinstance(kind, list) else kind
    if kind != "array":
        return {"number": "float", "integer": "int", "boolean": "bool", "string": "str"}[kind]
    if value["items"].get("type") == "array":
        return "Curve"
    inner = python_type(schema, value["items"])
    return "Vector" if inner == "float" and value.get("maxItems") == 3 else f"Sequence[{inner}]"


def named(schema: dict[str, dict], name: str) -> str:
    """A type by its name: words as literals, tables as their class."""
    it = schema[name]
    words = it.get("enum") or [one["const"] for one in it.get("oneOf", []) if "const" in one]
    return f"Literal[{', '.join(json.dumps(word) for word in words)}]" if words else name


if __name__ == "__main__":
    main()
