"""Messages as an older version of the product wrote them: without the fields that came later.

A trace holds the schemas of its own version. So a replay of an older trace leaves out later fields, and compares the
rest to the last byte.
"""

import json
from collections.abc import Mapping
from typing import Any

Schema = Mapping[str, Any]


class KnownFields:
    """The fields that the JSON schema of a topic names.

    Args:
        schema: The schema's text.

    Raises:
        ValueError: If the text is no JSON Schema.
    """

    def __init__(self, schema: bytes) -> None:
        try:
            self._root: Schema = json.loads(schema)
            self._definitions: Mapping[str, Schema] = self._root.get("$defs", {})
        except (AttributeError, RecursionError) as error:
            raise ValueError("no JSON Schema") from error

    def of(self, message: Any) -> Any:
        """Return a message, given as plain values, without the fields that the schema does not name.

        Raises:
            ValueError: If no message could have been written by the schema.
        """
        try:
            return self._known(message, self._root)
        except (KeyError, TypeError, AttributeError, RecursionError) as error:
            raise ValueError(f"{type(error).__name__}: {error}") from error

    def _known(self, value: Any, schema: Schema) -> Any:
        if isinstance(value, dict):
            return self._of_object(value, self._branch(value, schema))
        if isinstance(value, list):
            schema = self._branch(value, schema)
            first, others = schema.get("prefixItems", ()), schema.get("items")
            if not isinstance(others, dict) or ("type" in others and others["type"] not in ("object", "array")):
                others = {}
            if not others and not any("$ref" in each for each in first):
                return value
            return [self._known(item, first[i] if i < len(first) else others) for i, item in enumerate(value)]
        return value

    def _of_object(self, value: dict[str, Any], schema: Schema) -> dict[str, Any]:
        """Return the known fields of a model, or every entry of a map."""
        properties, entries = schema.get("properties"), schema.get("additionalProperties")
        if properties is not None:
            return {key: self._known(item, properties[key]) for key, item in value.items() if key in properties}
        return {key: self._known(item, entries) for key, item in value.items()} if isinstance(entries, dict) else value

    def _branch(self, value: Any, schema: Schema) -> Schema:
        """Return the part of a schema that describes this value: references followed, the alternative chosen."""
        if "$ref" in schema:
            return self._branch(value, self._definitions[schema["$ref"].rpartition("/")[2]])
        if "discriminator" in schema and isinstance(value, dict):
            chosen = schema["discriminator"]["mapping"].get(value.get(schema["discriminator"]["propertyName"]))
            return {} if chosen is None else self._branch(value, {"$ref": chosen})
        kind = "object" if isinstance(value, dict) else "array"
        for alternative in (*schema.get("anyOf", ()), *schema.get("oneOf", ())):
            branch = self._branch(value, alternative)
            if branch.get("type") == kind:
                return branch
        return schema
