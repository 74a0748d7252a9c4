"""What a value lacks of a JSON Schema, for those of its words that schema.json uses."""

import math
import re

KINDS = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int}
KNOWN = {
    *("$schema", "$id", "$defs", "$ref", "title", "description", "type", "const", "enum", "pattern"),
    *("minimum", "exclusiveMinimum", "items", "minItems", "maxItems"),
    *("properties", "required", "additionalProperties", "propertyNames", "minProperties", "oneOf"),
}


def faults(value, schema: dict, root: dict | None = None, place: str = "") -> list[str]:
    """What is wrong, as sentences; none if the value fits."""
    root = schema if root is None else root
    strange = set(schema) - KNOWN
    if strange:
        raise ValueError(f"schema: words {sorted(strange)} are not known here")
    if "$ref" in schema:
        return faults(value, root["$defs"][schema["$ref"].removeprefix("#/$defs/")], root, place)
    if "oneOf" in schema:
        found = [faults(value, each, root, place) for each in schema["oneOf"]]
        fitting = sum(not each for each in found)
        return [] if fitting == 1 else [f"{place}: fits {fitting} of {len(found)} forms: {min(found, key=len)}"]
    kind = schema.get("type")
    if kind and (not isinstance(value, KINDS[kind]) or isinstance(value, bool)):
        return [f"{place}: must be of type {kind}"]
    wrong = [f"{place}: {word}" for word in _plainly(value, schema)]
    if isinstance(value, dict):
        wrong += _of_object(value, schema, root, place)
    if isinstance(value, list) and "items" in schema:
        wrong += [each for n, part in enumerate(value) for each in faults(part, schema["items"], root, f"{place}[{n}]")]
    return wrong


def _plainly(value, schema):
    """What is wrong with a value by itself."""
    number = value if isinstance(value, int | float) else math.nan
    size = len(value) if isinstance(value, list | dict) else math.nan
    for word, broken in (
        ("const", "const" in schema and value != schema["const"]),
        ("enum", "enum" in schema and value not in schema["enum"]),
        ("pattern", isinstance(value, str) and not re.search(schema.get("pattern", ""), value)),
        ("minimum", number < schema.get("minimum", -math.inf)),
        ("exclusiveMinimum", number <= schema.get("exclusiveMinimum", -math.inf)),
        ("minItems", isinstance(value, list) and size < schema.get("minItems", 0)),
        ("maxItems", isinstance(value, list) and size > schema.get("maxItems", math.inf)),
        ("minProperties", isinstance(value, dict) and size < schema.get("minProperties", 0)),
    ):
        if broken:
            yield f"breaks {word} {schema[word]!r}"


def _of_object(value, schema, root, place):
    properties = schema.get("properties", {})
    wrong = [f"{place}: lacks {name!r}" for name in schema.get("required", ()) if name not in value]
    more = schema.get("additionalProperties", True)
    for name, part in value.items():
        here = f"{place}.{name}" if place else name
        if "propertyNames" in schema:
            wrong += faults(name, schema["propertyNames"], root, f"{here} (its name)")
        if name in properties:
            wrong += faults(part, properties[name], root, here)
        elif more is False:
            wrong.append(f"{here}: is not known")
        elif more is not True:
            wrong += faults(part, more, root, here)
    return wrong
