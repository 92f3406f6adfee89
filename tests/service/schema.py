"""Checks a value against a JSON schema: the part of draft 2020-12 that the schemas of client/schema use. A key that
this part lacks is an error, so that no rule goes unchecked."""
import re

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
PASSIVE = {"$schema", "$id", "$defs", "title", "description"}


def has_type(value, name):
    if name == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if name == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, TYPES[name])


def check(value, schema, root=None, place="$"):
    """Raises ValueError with the place of the first fault."""
    root = root or schema
    if "$ref" in schema:
        name = schema["$ref"].removeprefix("#/$defs/")
        check(value, root["$defs"][name], root, place)
        return
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    for key, rule in schema.items():
        if key in PASSIVE:
            ok = True
        elif key == "type":
            ok = any(has_type(value, name) for name in ([rule] if isinstance(rule, str) else rule))
        elif key == "const":
            ok = value == rule
        elif key == "enum":
            ok = value in rule
        elif key == "pattern":
            ok = not isinstance(value, str) or re.search(rule, value) is not None
        elif key == "minimum":
            ok = not number or value >= rule
        elif key == "maximum":
            ok = not number or value <= rule
        elif key == "exclusiveMinimum":
            ok = not number or value > rule
        elif key == "minItems":
            ok = not isinstance(value, list) or len(value) >= rule
        elif key == "maxItems":
            ok = not isinstance(value, list) or len(value) <= rule
        elif key == "required":
            ok = not isinstance(value, dict) or all(name in value for name in rule)
        elif key == "items":
            ok = True
            for i, item in enumerate(value if isinstance(value, list) else ()):
                check(item, rule, root, f"{place}[{i}]")
        elif key == "properties":
            ok = True
            for name in rule:
                if isinstance(value, dict) and name in value:
                    check(value[name], rule[name], root, f"{place}.{name}")
        elif key == "additionalProperties":
            ok = True
            named = schema.get("properties", {})
            for name in value if isinstance(value, dict) else ():
                if name not in named:
                    check(value[name], rule, root, f"{place}.{name}")
        else:
            raise ValueError(f"{place}: this check lacks '{key}'")
        if not ok:
            raise ValueError(f"{place}: {value!r} breaks {key} {rule!r}")
