/* Notes the device of a question, and how its stage times are measured. */
#ifndef SHEEN_TESTS_BENCH_TIMING_H
#define SHEEN_TESTS_BENCH_TIMING_H

#include "tests/bench/bench.h"
#include "tests/oracle/renderer.h"

void note_device(report *report, const struct renderer_info &info);

#endif
