"""Compiles programs in the dialect of shaders/lanes for each width of vectors that this processor has, and runs them
over two workgroups whose size is no multiple of a width."""
import os
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "shaders"))

from lanes.parse import Failure  # noqa: E402
from lanes.program import program_text  # noqa: E402

LOCAL, GROUPS = 20, 2
N = LOCAL * GROUPS
UNSET = 0xDEADBEEF  # the value of outputs that no invocation has written

# Two whole numbers and a float in, the same out, and a list with counters, for each invocation `i`.
HEAD = """layout(local_size_x = %d) in;
layout(binding = 0, rg32ui) readonly uniform uimage2D seen;
layout(binding = 1, r32f) readonly uniform image2D hit_depth;
layout(binding = 2, rg32ui) writeonly uniform uimage2D ends;
layout(binding = 3, r32f) writeonly uniform image2D coverage;
layout(std430, binding = 0) buffer Edges { uint x, y, z, n; uint at[]; } edges;
uniform uint stride;
uint whole_in(int k) { uvec2 u = imageLoad(seen, ivec2(int(gl_LocalInvocationIndex), int(gl_WorkGroupID.x))).xy; return u[k]; }
float float_in() { return imageLoad(hit_depth, ivec2(int(gl_LocalInvocationIndex), int(gl_WorkGroupID.x))).x; }
void put(uint a, uint b) { imageStore(ends, ivec2(int(gl_LocalInvocationIndex), int(gl_WorkGroupID.x)), uvec4(a, b, 0u, 0u)); }
void put_float(float a) { imageStore(coverage, ivec2(int(gl_LocalInvocationIndex), int(gl_WorkGroupID.x)), vec4(a)); }
""" % LOCAL

STRIDE = 5
WHOLE = [(i * 2654435761 >> 7) % 1000 for i in range(N)], [(i * 40503 + 12345) * 2654435761 % 2**32 for i in range(N)]
FLOATS = [(i - 17) * 0.375 for i in range(N)]

HOST = """
#include <stdio.h>
int main(void)
{
    enum { W = %(local)d, H = %(groups)d, N = W * H };
    static uint32_t whole[2 * N] = {%(whole)s}, out[2 * N], list[4 * N];
    static float floats[N] = {%(floats)s};
    static uint32_t out_floats[N];
    native_program *const programs[] = {%(programs)s};
    for (unsigned p = 0; p < sizeof programs / sizeof *programs; p++) {
        native_list edges = {0, 0, 0, 0, {list, 4 * N}};
        native_bindings b = {};
        b.seen = {whole, W, H, 2, N};
        b.hit_depth = {(uint32_t *)floats, W, H, 1, N};
        b.ends = {out, W, H, 2, N};
        b.coverage = {out_floats, W, H, 1, N};
        b.edges = &edges;
        b.stride = %(stride)d;
        for (int i = 0; i < 2 * N; i++)
            out[i] = %(unset)uu;
        for (int i = 0; i < N; i++)
            out_floats[i] = %(unset)uu;
        for (int i = 0; i < 4 * N; i++)
            list[i] = %(unset)uu;
        programs[p](&b, 0, H);
        for (int i = 0; i < 2 * N; i++)
            printf("%%u ", (unsigned)out[i]);
        for (int i = 0; i < N; i++)
            printf("%%u ", (unsigned)out_floats[i]);
        printf("%%u %%u %%u %%u", edges.x, edges.y, edges.z, edges.n);
        for (int i = 0; i < 4 * N; i++)
            printf(" %%u", (unsigned)list[i]);
        printf("\\n");
    }
}
"""


class Answer:
    """What one program has written: whole[k][i], floats[i] as bits, the counters x, y, z, n, and the list."""

    def __init__(self, line):
        words = [int(word) for word in line.split()]
        self.whole = words[:N], words[N:2 * N]
        self.floats = words[2 * N:3 * N]
        self.counters, self.list = words[3 * N:3 * N + 4], words[3 * N + 4:]


def widths():
    """The compiler flags for each number of lanes that this processor can run."""
    with open("/proc/cpuinfo", encoding="ascii") as file:
        text = file.read().split()
    if "sse4_2" not in text:
        return {4: []}
    found = {4: ["-march=x86-64-v2"]}
    if "avx2" in text and "fma" in text:
        found[8] = ["-march=x86-64-v3"]
    if {"avx512f", "avx512bw", "avx512vl", "avx512dq"} <= set(text):
        found[16] = ["-march=x86-64-v4", "-mprefer-vector-width=512"]
    return found


def translated(name, text):
    return program_text(HEAD + text, name)


def run_programs(programs, only_widest=False):
    """Runs [(name, text)]. Returns {lanes: [Answer of each program]}."""
    text = '#include "server/render/native/programs/glsl.hpp"\n' + "\n".join(
        translated(name, body).replace("Edges_block", name + "_edges") for name, body in programs)
    text += HOST % {"local": LOCAL, "groups": GROUPS, "stride": STRIDE, "unset": UNSET,
                    "whole": ", ".join("%du" % n for channel in WHOLE for n in channel),
                    "floats": ", ".join("%rf" % f for f in FLOATS),
                    "programs": ", ".join("SYMBOL(%s)" % name for name, _ in programs)}
    answers = {}
    with tempfile.TemporaryDirectory() as folder:
        source, program = os.path.join(folder, "programs.cpp"), os.path.join(folder, "programs")
        with open(source, "w", encoding="utf-8") as file:
            file.write(text)
        for lanes, flags in list(widths().items())[-1 if only_widest else 0:]:
            command = os.environ.get("CXX", "c++").split() + [
                "-std=c++17", "-w", "-O0", "-fno-math-errno", "-ffp-contract=off", *flags, "-I" + ROOT, "-DLANES=%d" % lanes,
                "-DLANE_SET=test", "-o", program, source]
            subprocess.run(command, check=True)
            said = subprocess.run([program], check=True, capture_output=True, text=True).stdout
            answers[lanes] = [Answer(line) for line in said.splitlines()]
    return answers


__all__ = ["Answer", "Failure", "FLOATS", "GROUPS", "HEAD", "LOCAL", "N", "STRIDE", "UNSET", "WHOLE", "run_programs",
           "translated", "widths"]
