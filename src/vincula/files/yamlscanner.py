"""ruamel.yaml's scanner and parser, asked less often.

The parser asks the scanner several times about every token, and the scanner looks each time whether
one of its open keys has become too old, though nothing was read in between.  The few methods that
take most of the time are replaced by ones that give the same answers; everything else, and so the
language, is ruamel.yaml's.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.parser import Parser
from ruamel.yaml.scanner import Scanner
from ruamel.yaml.tokens import ScalarToken

_WORD: Final = r"[A-Za-z0-9_.$][A-Za-z0-9_.$+*/()-]*"
_IN_BLOCK: Final = re.compile(_WORD + r"(?=:[ \n])", re.ASCII)
_IN_FLOW: Final = re.compile(_WORD + r"(?=[,\]}]|:[ \n])", re.ASCII)


class QuickScanner(Scanner):
    """The scanner of YAML 1.2, for text that is read once."""

    _looked: tuple[int, int] = (-1, -1)

    def stale_possible_simple_keys(self) -> None:
        """Forget keys that can be none any more; nothing to do where nothing was read since."""
        here = (self.reader.index, len(self.possible_simple_keys))
        if here != self._looked:
            super().stale_possible_simple_keys()
            self._looked = (here[0], len(self.possible_simple_keys))

    def need_more_tokens(self) -> bool:
        """Whether the next token cannot be given yet, because it may turn out to be a key."""
        if self.done:
            return False
        if not self.tokens:
            return True
        if not self.possible_simple_keys:
            return False
        self.stale_possible_simple_keys()
        return bool(self.next_possible_simple_key() == self.tokens_taken)

    def check_token(self, *choices: Any) -> bool:
        """Whether the next token is of one of some types."""
        while self.need_more_tokens():
            self.fetch_more_tokens()
        return bool(self.tokens) and (not choices or isinstance(self.tokens[0], choices))

    def scan_plain(self) -> Any:
        """A text without quotes; one plain word that ends where it must is taken in one piece."""
        reader = self.reader
        word = (_IN_FLOW if self.flow_context else _IN_BLOCK).match(reader.buffer, reader.pointer)
        if word is None:
            return super().scan_plain()
        start, length = reader.get_mark(), word.end() - word.start()
        reader.pointer += length
        reader.index += length
        reader.column += length
        self.allow_simple_key = False
        return ScalarToken(word.group(), True, start, reader.get_mark())


class QuickParser(Parser):
    """The parser, which keeps its scanner at hand."""

    _at_hand: Any = None

    if not TYPE_CHECKING:  # a property above, for which the checker knows no replacement

        @property
        def scanner(self) -> Any:
            """The scanner."""
            if self._at_hand is None:
                self._at_hand = super().scanner
            return self._at_hand


def yaml_events(text: str) -> Iterator[Any]:
    """The events of a YAML text.

    Raises:
        YAMLError: Not YAML.
    """
    reader = YAML(typ="safe", pure=True)
    reader.Scanner, reader.Parser = QuickScanner, QuickParser
    yield from reader.parse(text)
