/* A question that a benchmark answers. Each bench_NAME.cpp declares one at namespace scope, which
 * registers it in the program that it is linked into (main.cpp): one question alone, or several
 * from which the command line chooses. */
#ifndef SHEEN_TESTS_BENCH_QUESTION_H
#define SHEEN_TESTS_BENCH_QUESTION_H

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/bench.h"

struct question {
    std::string name;              /* name on the command line */
    std::string asks;              /* one line for the help */
    std::vector<std::string> keys; /* further --keys that it accepts */
    std::function<void(report *report)> ask;

    question(const char *name, const char *asks, std::vector<std::string> keys,
             std::function<void(report *report)> ask);
    question(const question &) = delete;
    question &operator=(const question &) = delete;
};

#endif
