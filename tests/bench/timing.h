/* Says on which device a question was asked, and what its stage times are. */
#ifndef SHEEN_TESTS_BENCH_TIMING_H
#define SHEEN_TESTS_BENCH_TIMING_H

#include "tests/bench/bench.h"
#include "tests/oracle/renderer.h"

void note_device(report *report, const struct renderer_info &info);

#endif
