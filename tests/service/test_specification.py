"""protocol/FIELDS.md has a row for every field of every message of sheen.proto, and none for what does not exist."""
import os
import re
import unittest

PROTOCOL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "protocol")


def read(name):
    with open(os.path.join(PROTOCOL, name), encoding="utf-8") as file:
        return file.read()


def fields_of_schema(text):
    """{message: its fields}."""
    messages = re.findall(r"^message (\w+) \{(.*?)^\}", text, re.M | re.S)
    return {name: re.findall(r"^\s+(?:required|optional|repeated) \w+ (\w+) = \d+", body, re.M)
            for name, body in messages}


def fields_of_tables(text):
    """{message: the fields of its table}. A row may have several fields, separated by commas."""
    tables = re.findall(r"^\| (\w+) \|.*\n\|---\|---\|\n((?:\|.*\n)+)", text, re.M)
    return {name: [field for row in rows.splitlines() for field in row.split("|")[1].strip().split(", ")]
            for name, rows in tables}


class Fields(unittest.TestCase):
    def test_every_field_has_one_row(self):
        schema, tables = fields_of_schema(read("sheen.proto")), fields_of_tables(read("FIELDS.md"))
        self.assertGreater(len(schema), 30)
        self.assertEqual(sorted(schema), sorted(tables))
        for message, fields in schema.items():
            with self.subTest(message=message):
                self.assertEqual(sorted(fields), sorted(tables[message]))

    def test_every_row_says_something(self):
        for row in re.findall(r"^\| [a-z_, 0-9]+ \|.*", read("FIELDS.md"), re.M):
            self.assertRegex(row, r"\| [^|]{5,} \|$")


if __name__ == "__main__":
    unittest.main()
