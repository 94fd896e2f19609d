"""Sobol' sequence of 40 dimensions, in Gray-code order.

SciPy has the same sequence in `scipy.stats.qmc`, whose import takes longer than many
traces.

References: I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (4), 1967; S. Joe and F. Kuo,
SIAM J. Sci. Comput. 30, 2008 (primitive polynomials and initial direction numbers);
I. A. Antonov and V. M. Saleev, USSR Comput. Math. Math. Phys. 19 (1), 1979 (Gray code).
"""

from functools import cache

import numpy as np
from jaxtyping import UInt32

_BITS = 32

# For each dimension: primitive polynomial, its coefficients as the bits of a number,
# and the first direction numbers
_DIMENSIONS = """
1 1
3 1
7 1 3
11 1 3 1
13 1 1 1
19 1 1 3 3
25 1 3 5 13
37 1 1 5 5 17
41 1 1 5 5 5
47 1 1 7 11 19
55 1 1 5 1 1
59 1 1 1 3 11
61 1 3 5 5 31
67 1 3 3 9 7 49
91 1 1 1 15 21 21
97 1 3 1 13 27 49
103 1 1 1 15 7 5
109 1 3 1 15 13 25
115 1 1 5 5 19 61
131 1 3 7 11 23 15 103
137 1 3 7 13 13 15 69
143 1 1 3 13 7 35 63
145 1 3 5 9 1 25 53
157 1 3 1 13 9 35 107
167 1 3 1 5 27 61 31
171 1 1 5 11 19 41 61
185 1 3 5 3 3 13 69
191 1 1 7 13 1 19 1
193 1 3 7 5 13 19 59
203 1 1 3 9 25 29 41
211 1 3 5 13 23 1 55
213 1 3 7 3 13 59 17
229 1 3 1 3 5 53 69
239 1 1 5 5 23 33 13
241 1 1 7 7 1 61 123
247 1 1 7 9 13 61 49
253 1 3 3 5 3 55 33
285 1 3 1 15 31 13 49 245
299 1 3 5 15 31 59 63 97
301 1 3 1 11 11 11 77 249
"""


def sobol(first: int, count: int) -> UInt32[np.ndarray, "dimension point"]:
    """Return the points `first` to `first + count`, coordinates times 2^32.

    >>> (sobol(0, 4)[:2] / 2**32).tolist()
    [[0.0, 0.5, 0.75, 0.25], [0.0, 0.5, 0.25, 0.75]]
    """
    bits = (count - 1).bit_length()
    start, directions = first >> bits << bits, _directions()
    # Gray codes of a block of 2^bits points: that of its start, plus those from 0
    block = np.zeros((len(directions), 1), dtype=np.uint32)
    for bit in range(bits):
        block = np.concatenate([block, block ^ _sum(directions, 1 << bit)], axis=1)
    starts = range(start, first + count, 1 << bits)
    found = np.concatenate([block ^ _sum(directions, at) for at in starts], axis=1)
    return found[:, first - start : first - start + count]


def _sum(
    directions: UInt32[np.ndarray, "dimension bit"], index: int
) -> UInt32[np.ndarray, "dimension 1"]:
    # Point of an index: sum without carry over the bits of its Gray code
    gray = index ^ (index >> 1)
    chosen = [bit for bit in range(gray.bit_length()) if gray >> bit & 1]
    return np.bitwise_xor.reduce(directions[:, chosen], axis=1, keepdims=True)


@cache
def _directions() -> UInt32[np.ndarray, "dimension bit"]:
    # Direction numbers, by the recurrence of each primitive polynomial
    lines = _DIMENSIONS.split("\n")[1:-1]
    found = np.zeros((len(lines), _BITS), dtype=np.uint32)
    for row, line in zip(found, lines, strict=True):
        polynomial, *numbers = map(int, line.split())
        degree = polynomial.bit_length() - 1
        if degree == 0:  # van der Corput sequence
            numbers = [1] * _BITS
        for bit in range(len(numbers), _BITS):
            number = numbers[bit - degree] ^ (numbers[bit - degree] << degree)
            for step in range(1, degree):
                if polynomial >> (degree - step) & 1:
                    number ^= numbers[bit - step] << step
            numbers.append(number)
        row[:] = [n << (_BITS - 1 - bit) for bit, n in enumerate(numbers)]
    return found
