"""Makes the module sheen.messages from the protocol's own files.

sheen.proto has the messages and their fields, sheen.options their bounds, and README.md the version, the types of
messages and the limits of their bodies. The module has a dataclass for each message, so that names and types of fields
are checked by mypy, and a table of its fields, by which sheen.protobuf encodes and decodes it."""
import re
import sys

SCALARS = {"uint32": "int", "uint64": "int", "bool": "bool", "double": "float", "float": "float",
           "string": "str", "bytes": "bytes"}
FIELD = re.compile(r"(required|optional|repeated) (\w+) (\w+) = (\d+)(?: \[default = \w+(?:\.\w+)?\])?;")


def blocks(text):
    """The enums and messages of sheen.proto as (kind, name, content), in their order."""
    text = re.sub(r"//.*", "", text)
    return re.findall(r"^(enum|message) (\w+) \{(.*?)\}", text, re.S | re.M)


def bounds_of(text):
    """The options of each field: {"Hello.client": {"max_length": 63}}."""
    found = {}
    for line in re.sub(r"#.*", "", text).splitlines():
        name, _, rest = line.strip().partition(" ")
        if name:
            found[name.removeprefix("sheen.")] = dict(part.split(":") for part in rest.split())
    return found


def enum(name, content):
    members = re.findall(r"(\w+) = (\d+);", content)
    return [f"class {name}(enum.IntEnum):", *(f"    {member} = {number}" for member, number in members), "", ""]


def message(name, content, enums, messages, bounds):
    content = re.sub(r"\breserved [^;]*;", "", content)
    rows, table = [], []
    fields = FIELD.findall(content)
    left = FIELD.sub("", content).strip()
    if left:
        sys.exit(f"tables.py: message {name}: cannot read '{left.splitlines()[0]}'")
    # Fields with a default follow those without.
    for label, kind, field, number in fields:
        bound = bounds.get(f"{name}.{field}", {})
        if kind in SCALARS:
            python, wire = SCALARS[kind], f'"{kind}"'
        elif kind in enums:
            python, wire = "int", '"enum"'
        elif kind in messages:
            python, wire = kind, kind
        else:
            sys.exit(f"tables.py: message {name}: {field} has the type {kind}, which is not known or comes later")
        if label == "repeated":
            rows.append(f"    {field}: list[{python}] = field(default_factory=list)")
        elif label == "optional":
            rows.append(f"    {field}: {python} | None = None")
        else:
            rows.append(f"    {field}: {python}")
        most = bound.get("max_length") or bound.get("max_size") or bound.get("max_count")
        fixed = bound.get("fixed_length") == "true"
        table.append(f'    Field({number}, "{field}", {wire}, "{label}", {most}, {fixed}),')
    return ["@dataclass(kw_only=True)", f"class {name}(Message):", *rows, "", "",
            f"{name}.FIELDS = fields(", *table, ")", "", ""]


def limits(text):
    """Version, types of messages, and the greatest bodies, from the tables of README.md."""
    minor = re.search(r"^# .* version 1\.(\d+)$", text, re.M).group(1)
    types = re.findall(r"^\| (\d+) \| ([A-Z_]+) \| (?:client|server) \|", text, re.M)
    bodies = {}
    for names, size in re.findall(r"^\| body of ([A-Z_, ]+) \| (\d+)(?: bytes)? \|", text, re.M):
        bodies.update((name, size) for name in names.split(", "))
    other = re.search(r"^\| any other body \| (\d+) bytes \|", text, re.M).group(1)
    return [f"MINOR = {minor}  # the highest minor version that this client speaks", "", "",
            "class Type(enum.IntEnum):", *(f"    {name} = {number}" for number, name in types), "", "",
            "MAX_BODY_BYTES = {", *(f"    Type.{name}: {bodies.get(name, other)}," for _, name in types), "}", "", ""]


def module(folder):
    """The text of the module, by the files in this folder."""
    texts = []
    for name in ("sheen.proto", "sheen.options", "README.md"):
        with open(f"{folder}/{name}", encoding="utf-8") as file:
            texts.append(file.read())
    bounds = bounds_of(texts[1])
    lines = ['"""The messages of the protocol. client/python/tables.py has made this file from protocol/."""',
             "from __future__ import annotations", "", "import enum", "from dataclasses import dataclass, field", "",
             "from sheen.protobuf import Field, Message, fields", "", *limits(texts[2])]
    enums, messages = set(), set()
    for kind, name, content in blocks(texts[0]):
        if kind == "enum":
            lines += enum(name, content)
            enums.add(name)
        else:
            lines += message(name, content, enums, messages, bounds)
            messages.add(name)
    return "\n".join(lines).rstrip() + "\n"
