"""test_lanes.py: programs translated by shaders/lanes give the values that each invocation gives alone, which are
computed here. A program outside of the dialect is refused with its place."""
import struct
import sys
import unittest

from lanes_host import FLOATS, HEAD, LOCAL, N, STRIDE, UNSET, WHOLE, Failure, run_programs, translated
from lanes.constant import rows
from lanes_random import random_program

MASK = 2**32 - 1
A, B = WHOLE


def bits(number):
    return struct.unpack("<I", struct.pack("<f", number))[0]


def rounded(number):
    """The value as a float in single precision."""
    return struct.unpack("<f", struct.pack("<f", number))[0]


class Case:
    """A program. of(i) are the values of invocation i: two unsigned integers, and a float or None. counters and at:
    the counters of the list, and its elements, for programs that use them."""

    def __init__(self, text, of, counters=None, at=None):
        self.text, self.of, self.counters, self.at = text, of, counters, at


def trips(i):
    """The number of the loop's iterations below."""
    total, k = 0, 0
    while k < A[i] % 13:
        k += 1
        if k % 3 == 2:
            continue
        if total > 40:
            break
        total += k
    return total, k


def inner_loops(i):
    total = 0
    for j in range(A[i] % 4):
        for k in range(B[i] % 5):
            if k > j:
                break
            total += 10 * j + k + 1
        if total > 30:
            return total, 7
    return total, 8


def early(i):
    """Changes before the return remain."""
    a = A[i]
    if a % 3 == 0:
        return a + 1, 1
    if a % 3 == 1:
        return a + 2, 2
    return a + 4, 3


def picked(i):
    array = [11, 22, 33, 44]
    array[A[i] % 4] += B[i] % 100
    return array[A[i] % 4], array[min(A[i] % 9, 3)]


def struct_of(i):
    pair = (A[i] % 7, rounded(FLOATS[i] * 2))
    return (pair[0] * 3, 1, pair[1]) if pair[1] > 0 else (pair[0], 0, -pair[1])


CASES = {
    "uniform_and_varying": Case(
        """void main() { uint u = stride * 2u; u += 1u; uint v = u + whole_in(0); if (stride > 4u) v += 100u; else v = 0u;
           put(u, v); }""",
        lambda i: (2 * STRIDE + 1, (2 * STRIDE + 101 + A[i]) & MASK, None)),
    "branches": Case(
        """void main() { uint a = whole_in(0), r = 5u, s = 0u; if (a % 2u == 0u) { r = a; if (a % 3u == 0u) s = 1u; else s = 2u; }
           else { r += 7u; uint a = 3u; s = a; } put(r, s); }""",
        lambda i: (A[i], 1 if A[i] % 3 == 0 else 2, None) if A[i] % 2 == 0 else (12, 3, None)),
    "loop_by_lane": Case(
        """void main() { uint n = whole_in(0) % 13u, total = 0u, k = 0u;
           while (k < n) { k++; if (k % 3u == 2u) continue; if (total > 40u) break; total += k; } put(total, k); }""",
        lambda i: (*trips(i), None)),
    "loop_of_all": Case(
        """void main() { uint total = 0u; for (uint k = 0u; k < stride; k++) { if (k == 2u) continue; total += k * whole_in(0); }
           put(total, 0u); }""",
        lambda i: (sum(k * A[i] for k in range(STRIDE) if k != 2), 0, None)),
    "loops_and_return": Case(
        """uint run(out uint how) { how = 8u; uint total = 0u;
             for (uint j = 0u; j < whole_in(0) % 4u; j++) {
               for (uint k = 0u; k < whole_in(1) % 5u; k++) { if (k > j) break; total += 10u * j + k + 1u; }
               if (total > 30u) { how = 7u; return total; } }
             return total; }
           void main() { uint how; uint total = run(how); put(total, how); }""",
        lambda i: (*inner_loops(i), None)),
    "early_return": Case(
        """uint early(inout uint a) { if (a % 3u == 0u) { a += 1u; return 1u; }
             if (a % 3u == 1u) { a += 2u; return 2u; } a += 4u; return 3u; }
           void main() { uint a = whole_in(0); uint how = early(a); put(a, how); }""",
        lambda i: (*early(i), None)),
    "no_lane_left": Case(
        """void main() { if (whole_in(0) < 2000u) return; put(1u, 2u); }""",
        lambda i: (UNSET, UNSET, None)),
    "some_lanes_leave": Case(
        """void main() { uint a = whole_in(0); if (a % 2u == 1u) return; put(a, 2u); }""",
        lambda i: (A[i], 2, None) if A[i] % 2 == 0 else (UNSET, UNSET, None)),
    "short_circuit": Case(
        """bool counted(uint a) { atomicAdd(edges.x, 1u); return a % 2u == 0u; }
           void main() { uint a = whole_in(0), r = 0u; if (a % 3u == 0u && counted(a)) r = 1u; if (a % 5u == 0u || counted(a)) r += 2u;
           put(r, 0u); }""",
        lambda i: ((A[i] % 3 == 0 and A[i] % 2 == 0) + 2 * (A[i] % 5 == 0 or A[i] % 2 == 0), 0, None),
        counters=[sum((a % 3 == 0) + (a % 5 != 0) for a in A), 0, 0, 0]),
    "choice_that_calls": Case(
        """uint one(uint a) { atomicAdd(edges.y, 1u); return a + 1u; } uint other(uint a) { atomicAdd(edges.z, 1u); return a * 2u; }
           void main() { uint a = whole_in(0); put(a > 500u ? one(a) : other(a), a > 500u ? 1u : 2u); }""",
        lambda i: (A[i] + 1, 1, None) if A[i] > 500 else (2 * A[i], 2, None),
        counters=[0, sum(a > 500 for a in A), sum(a <= 500 for a in A), 0]),
    "arrays": Case(
        """void main() { uint a = whole_in(0), b = whole_in(1); uint array[4] = uint[4](11u, 22u, 33u, 44u);
           array[a % 4u] += b % 100u; put(array[a % 4u], array[a % 9u]); }""",  # an index beyond the end: the last
        lambda i: (*picked(i), None)),
    "constants": Case(
        """const uint TABLE[3] = uint[3](5u, 6u, 9u); const int SIDE = 2; const int AREA = SIDE * SIDE + 1;
           void main() { put(TABLE[whole_in(0) % 3u], uint(AREA)); }""",
        lambda i: ([5, 6, 9][A[i] % 3], 5, None)),
    "division": Case(  # inactive lanes divide by 0
        """void main() { uint a = whole_in(0) % 3u, r = 9u; if (a != 0u) r = 1000u / a; put(r, a == 0u ? 1u : whole_in(1) % a); }""",
        lambda i: (1000 // (A[i] % 3) if A[i] % 3 else 9, B[i] % (A[i] % 3) if A[i] % 3 else 1, None)),
    "swizzles": Case(
        """void main() { uvec3 v = uvec3(whole_in(0), whole_in(1), 7u); v.zx = v.xy; v.y += 1u; uvec2 w = v.zy; put(w.x + v.r, w.y); }""",
        lambda i: ((A[i] + B[i]) & MASK, (B[i] + 1) & MASK, None)),
    "structs": Case(
        """struct Pair { uint n; float f; };
           Pair twice(Pair p) { p.f *= 2.0; if (p.f > 0.0) { p.n *= 3u; return p; } p.f = -p.f; return p; }
           void main() { Pair p = Pair(whole_in(0) % 7u, float_in()); Pair q = twice(p); put(q.n, uint(p.f > 0.0)); put_float(q.f); }""",
        struct_of),
    "overloads": Case(
        """uint of(float a) { return 1u; } uint of(uint a) { return 2u; } uint of(vec2 a) { return 4u; } float wide(float a) { return a * 0.5; }
           void main() { put(of(1.0) + of(whole_in(0)) * 8u + of(vec2(0.0)) * 64u, 0u); put_float(wide(3)); }""",
        lambda i: (1 + 16 + 256, 0, 1.5)),
    "numbers": Case(
        """void main() { float x = float_in(); int n = int(floor(x)); put(uint(n), uint(abs(n)) << 2u);
           put_float(clamp(fract(x), 0.25, 0.5) + max(x, 1.0)); }""",
        lambda i: (int(FLOATS[i] // 1) & MASK, abs(int(FLOATS[i] // 1)) * 4,
                   min(max(FLOATS[i] % 1, 0.25), 0.5) + max(FLOATS[i], 1.0))),
    "bits": Case(
        """void main() { uint b = whole_in(1); put(uint(bitCount(b)) + uint(findLSB(b)) * 64u, (b >> 3u) ^ (b << 5u)); }""",
        lambda i: (bin(B[i]).count("1") + 64 * ((B[i] & -B[i]).bit_length() - 1), (B[i] >> 3) ^ (B[i] << 5) & MASK, None)),
    "matrices": Case(
        """void main() { float x = float_in(); mat2 m = mat2(x, 1.0, 2.0, 3.0); vec2 v = m * vec2(1.0, x); put(0u, 0u);
           put_float(v.x + 10.0 * v.y + dot(m[1], vec2(1.0, 0.0))); }""",
        lambda i: (0, 0, FLOATS[i] + 2 * FLOATS[i] + 10 * (1 + 3 * FLOATS[i]) + 2)),
    "lists": Case(  # in the order of the lanes
        """void main() { uint a = whole_in(0); put(0u, 0u); if (a % 2u == 0u) { uint at = atomicAdd(edges.n, 1u); edges.at[at] = a; }
           atomicMax(edges.x, a); }""",
        lambda i: (0, 0, None), counters=[max(A), 0, 0, sum(a % 2 == 0 for a in A)], at=[a for a in A if a % 2 == 0]),
    "beyond_a_list": Case(  # nothing is written beyond the end, and a read there gives the last element
        """void main() { edges.at[160u + whole_in(0)] = 1u; edges.at[159] = 5u; put(edges.at[whole_in(0) + 160u], 0u); }""",
        lambda i: (5, 0, None), at=[UNSET] * 159 + [5]),
    "barriers": Case(
        """shared uint common[%d];
           void main() { uint i = gl_LocalInvocationIndex; uint a = whole_in(0); common[i] = a; barrier(); uint next = common[(i + 1u) %% %du];
           barrier(); common[i] = next * 2u; barrier(); put(next + a, common[(i + %du) %% %du]); }""" % (LOCAL, LOCAL, LOCAL - 1, LOCAL),
        lambda i: ((A[beside(i, 1)] + A[i]) & MASK, 2 * A[i], None)),
}


def beside(i, step):
    """The invocations of the same workgroup."""
    return i // LOCAL * LOCAL + (i + step) % LOCAL


# (text after HEAD, whose first line is line 1; the line that is refused; words of the error)
REFUSED = [
    ("void main() {\n    switch (1) { }\n}", 2, "';' is wanted"),
    ("void main() {\n    do { } while (true);\n}", 2, "';' is wanted"),
    ("void main() {\n    uint a = 1u, b;\n    a = 1u, b = 2u;\n}", 3, "no comma operator"),
    ("void main() {\n    uint a[2][3];\n}", 2, "';' is wanted"),
    ("uniform sampler2D pictures[2];\nvoid main() { }", 1, "an array of textures has one"),
    ("void main() {\n    image2D own;\n}", 2, "images and textures are global"),
    ("buffer Open { uint first[]; uint n; } open;\nvoid main() { }", 1, "is its last member"),
    ("void main() {\n    uint a = 0u;\n    atomicAdd(a, 1u);\n}", 3, "a number of a block"),
    ("void main() {\n    atomicAdd(edges.at[1], 1u);\n}", 2, "a number of a block"),
    ("void main() {\n    if (stride > 1u) {\n        barrier();\n    }\n}", 3, "main() itself"),
    ("void wait() {\n    barrier();\n}\nvoid main() {\n    wait();\n}", 2, "main() itself"),
    ("void main() {\n    if (whole_in(0) > 1u)\n        return;\n    barrier();\n}", 4, "before any return"),
    ("uint turn(uint a) {\n    return a > 1u ? turn(a - 1u) : a;\n}\nvoid main() { put(turn(3u), 0u); }", 2, "calls itself"),
    ("void main() {\n    stride = 1u;\n}", 2, "this global cannot be assigned"),
    ("void main() {\n    1u = 2u;\n}", 2, "cannot be assigned"),
    ("void main() {\n    put(other, 0u);\n}", 2, "other is not declared"),
    ("void main() {\n    put(hypot(1.0), 0u);\n}", 2, "no function hypot"),
    ("void main() {\n    put(1.0);\n}", 2, "no put takes these arguments"),
    ("struct Pair { uint a; };\nvoid main() {\n    Pair p = Pair(1u);\n    put(p.b, 0u);\n}", 4, "no member b"),
    ("void main() {\n    vec2 v = vec2(1.0);\n    put(uint(v.z), 0u);\n}", 3, "no .z of this"),
    ("void main() {\n    vec2 v = vec2(1.0);\n    put(uint(v.q1), 0u);\n}", 3, "no .q1 of this"),
    ("void main() {\n    float f = 1.0;\n    put(uint(f.x), uint(f[0]));\n}", 3, "no .x of this"),
    ("void main() {\n    float f = 1.0;\n    put(0u, uint(f[0]));\n}", 3, "no element of this"),
    ("shared uint result[4];\nvoid main() { }", 1, "result is a name of the C++"),
    ("uint sized[1 % 2];\nvoid main() { }", 1, "no constant"),
    ("#if 1\nvoid main() { }\n#endif", 1, "is no token"),
    ("void main() {\n    put(1u, 0u);\n", 3, "a value is wanted"),
]


class Lanes(unittest.TestCase):
    def check_case(self, case, answer):
        for i in range(N):
            first, second, number = case.of(i)
            self.assertEqual((answer.whole[0][i], answer.whole[1][i]), (first, second), "invocation %d" % i)
            if number is not None:
                self.assertEqual(answer.floats[i], bits(rounded(number)), "invocation %d" % i)
        if case.counters:
            self.assertEqual(answer.counters, case.counters)
        if case.at:
            self.assertEqual(answer.list, case.at + [UNSET] * (4 * N - len(case.at)))

    def test_programs(self):
        for lanes, answers in run_programs([(name, case.text) for name, case in CASES.items()]).items():
            self.assertEqual(len(answers), len(CASES))
            for (name, case), answer in zip(CASES.items(), answers):
                with self.subTest(lanes=lanes, name=name):
                    self.check_case(case, answer)

    def test_random_programs(self):
        """Random branches, loops, returns, arrays and calls give what the interpreter gives, invocation by
        invocation."""
        programs = [random_program(seed) for seed in range(8)]
        texts = [("random_%d" % k, text) for k, (text, _) in enumerate(programs)]
        n_values = len({tuple(of(i) for i in range(N)) for _, of in programs})
        self.assertGreater(n_values, 5)  # the programs compute different values
        for lanes, answers in run_programs(texts, only_widest=True).items():
            for k, (answer, (text, of)) in enumerate(zip(answers, programs)):
                for i in range(N):
                    self.assertEqual((answer.whole[0][i], answer.whole[1][i]), of(i),
                                     "seed %d, %d lanes, invocation %d of\n%s" % (k, lanes, i, text))

    def test_refusals(self):
        above = HEAD.count("\n")
        for text, line, words in REFUSED:
            with self.subTest(text=text):
                with self.assertRaises(Failure) as caught:
                    translated("refused", text)
                place, _, said = str(caught.exception).partition(": ")
                self.assertEqual(place, "line %d" % (above + line))
                self.assertIn(words, said)

    def test_places(self):
        """The preprocessor's line markers tell in which file a line stands."""
        with self.assertRaises(Failure) as caught:
            translated("refused", '# 7 "view.glsl"\nvoid main() {\n\n# 3 "hit.glsl" 2\n    put(x, 0u);\n}')
        self.assertEqual(str(caught.exception), "hit.glsl:3: x is not declared")

    def test_a_constant_in_c(self):
        text = ("const float A = 1.0;\nconst vec2 B[2] = vec2[2](\n    vec2(-0.5, 1.25),\n    vec2(0.75, .5));\n"
                "const vec2 C[1] = vec2[1](vec2(A, 1.0));\n")
        self.assertEqual(rows(text, "B"), [["-0.5f", "1.25f"], ["0.75f", ".5f"]])
        for name, words in (("A", "line 1: A is no array of float vectors"), ("C", "line 5: a number with a point is wanted"),
                            ("D", "there is no constant D")):
            with self.assertRaises(Failure) as caught:
                rows(text, name)
            self.assertEqual(str(caught.exception), words)


if __name__ == "__main__":
    ran = unittest.main(exit=False, argv=sys.argv[:1], verbosity=2).result
    bad = len(ran.failures) + len(ran.errors)
    print("%d passed, %d failed" % (max(ran.testsRun - bad, 0), bad))
    sys.exit(bad != 0)
