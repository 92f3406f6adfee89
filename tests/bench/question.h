/* What a benchmark asks. Each bench_NAME.cpp says it once, at namespace scope, and so is known to
 * the program that it is linked into (main.cpp): one question by itself, or several of which the
 * command line chooses. */
#ifndef SHEEN_TESTS_BENCH_QUESTION_H
#define SHEEN_TESTS_BENCH_QUESTION_H

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/bench.h"

struct question {
    std::string name;              /* what the command line calls it */
    std::string asks;              /* a line for the help */
    std::vector<std::string> keys; /* the --keys that it knows beside everyone's */
    std::function<void(report *report)> ask;

    question(const char *name, const char *asks, std::vector<std::string> keys,
             std::function<void(report *report)> ask);
    question(const question &) = delete;
    question &operator=(const question &) = delete;
};

#endif
