"""Why derivatives do not exist, by place: one number a place, every sentence kept once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np


class GradientReasons(Mapping[tuple[int, ...], str]):
    """Sentences by place in a batch; most places have none, and many share theirs.

    Args:
        shape: Dimensions of the places.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self._codes = np.zeros(shape, dtype=np.int32)
        self._words: dict[str, int] = {"": 0}
        self._list = [""]

    def __setitem__(self, place: tuple[int, ...], words: str) -> None:
        if words not in self._words:
            self._words[words] = len(self._list)
            self._list.append(words)
        self._codes[place] = self._words[words]

    def __getitem__(self, place: tuple[int, ...]) -> str:
        if not isinstance(place, tuple) or len(place) != self._codes.ndim:
            raise KeyError(place)
        try:
            code = int(self._codes[place])
        except IndexError:
            raise KeyError(place) from None
        if not code:
            raise KeyError(place)
        return self._list[code]

    def __iter__(self) -> Iterator[tuple[int, ...]]:
        return (tuple(int(k) for k in place) for place in np.argwhere(self._codes))

    def __len__(self) -> int:
        return int(np.count_nonzero(self._codes))

    def reshaped(self, shape: tuple[int, ...]) -> GradientReasons:
        """The same sentences where the places have other dimensions.

        Args:
            shape: As many places.
        """
        found = GradientReasons(())
        found._codes, found._words, found._list = self._codes.reshape(shape), self._words, self._list
        return found
