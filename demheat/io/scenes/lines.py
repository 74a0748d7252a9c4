"""In which line of a TOML text each key stands: what `tomllib` does not tell.

The text must be valid TOML, which `tomllib` has seen to: this reader only walks over it, and knows every key of every
table, inline ones and those in arrays included, for sure.
"""

import bisect
import re

BLANK = re.compile(r"[ \t]*")
# Blanks, line breaks, comments and commas: what stands between the parts of an array.
BETWEEN = re.compile(r"(?:[\s,]|#[^\n]*)*")
WORD = re.compile(r"[A-Za-z0-9_-]+")
PLAIN = re.compile(r"[^,\]}#\n]*")
# Strings: several lines before one line.
STRINGS = (
    re.compile(r'"""(?:[^\\]|\\.)*?"""(?:"{0,2})', re.DOTALL),
    re.compile(r"'''.*?'''(?:'{0,2})", re.DOTALL),
    re.compile(r'"(?:[^"\\\n]|\\.)*"'),
    re.compile(r"'[^'\n]*'"),
)
SHORT = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r", '"': '"', "\\": "\\", "e": "\x1b"}
ESCAPE = re.compile(r"\\(?:u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))")


def lines_of(text: str) -> dict[tuple, int]:
    """Lines of all keys and members of arrays."""
    return _Walk(text).found


class _Walk:
    """One walk over a text, from `at` on."""

    def __init__(self, text):
        self.text, self.at, self.found, self.counts = text, 0, {}, {}
        self.starts = [0, *(found.end() for found in re.finditer("\n", text))]
        table = ()
        while self._skip(BETWEEN):
            if self.text[self.at] == "[":
                table = self._header()
            else:
                self._pair(table)

    def _skip(self, pattern):
        """Go over what fits; whether anything is left."""
        self.at = pattern.match(self.text, self.at).end()
        return self.at < len(self.text)

    def _mark(self, path):
        self.found.setdefault(path, bisect.bisect_right(self.starts, self.at))

    def _header(self):
        """A line [table] or [[array]]; the path of what follows."""
        many = self.text.startswith("[[", self.at)
        begun, self.at = self.at, self.at + 1 + many
        path = ()
        for key in self._keys():
            path = self._last(path) + (key,)
            end, self.at = self.at, begun
            self._mark(path)
            self.at = end
        self.at += 1 + many
        if many:
            self.counts[path] = self.counts.get(path, -1) + 1
            end, self.at = self.at, begun
            self._mark(self._last(path))
            self.at = end
        return self._last(path)

    def _last(self, path):
        """Into the last member, of an array of tables."""
        return (*path, self.counts[path]) if path in self.counts else path

    def _pair(self, table):
        """One `key = value`."""
        begun, path = self.at, table
        for key in self._keys():
            path = (*path, key)
            end, self.at = self.at, begun
            self._mark(path)
            self.at = end
        self.at += 1
        self._value(path)

    def _keys(self):
        """Parts of a dotted key; ends behind them and the blanks."""
        keys = []
        while True:
            self._skip(BLANK)
            if self.text[self.at] in "\"'":
                keys.append(self._string())
            else:
                word = WORD.match(self.text, self.at)
                self.at = word.end()
                keys.append(word[0])
            self._skip(BLANK)
            if self.text[self.at] != ".":
                return keys
            self.at += 1

    def _value(self, path):
        self._skip(BLANK)
        first = self.text[self.at]
        if first == "[":
            self.at += 1
            number = 0
            while self._skip(BETWEEN) and self.text[self.at] != "]":
                self._mark((*path, number))
                self._value((*path, number))
                number += 1
            self.at += 1
        elif first == "{":
            self.at += 1
            while self._skip(BETWEEN) and self.text[self.at] != "}":
                self._pair(path)
            self.at += 1
        elif first in "\"'":
            self._string()
        else:
            self._skip(PLAIN)

    def _string(self):
        found = next(filter(None, (pattern.match(self.text, self.at) for pattern in STRINGS)))
        self.at = found.end()
        # Keys are strings of one line.
        return ESCAPE.sub(_unescaped, found[0][1:-1]) if found[0][0] == '"' else found[0][1:-1]


def _unescaped(found):
    return chr(int(found[1] or found[2], 16)) if found[1] or found[2] else SHORT.get(found[3], found[3])
