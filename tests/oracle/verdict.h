/* Counts and prints passes and failures, and ends a test program. */
#ifndef SHEEN_TESTS_ORACLE_VERDICT_H
#define SHEEN_TESTS_ORACLE_VERDICT_H

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

struct verdict {
    int passed = 0, failed = 0;

    /* Records one check; prints `what` on failure. Returns ok. */
    bool check(bool ok, const std::string &what)
    {
        ok ? passed++ : failed++;
        if (!ok)
            std::printf("  FAILED: %s\n", what.c_str());
        return ok;
    }
    /* Checks value <= bound; NaN fails. */
    bool at_most(double value, double bound, const std::string &what)
    {
        char text[96];
        std::snprintf(text, sizeof text, ": %.3g, at most %.3g allowed", value, bound);
        return check(value <= bound, what + text);
    }
    /* Prints the program's last line and returns its exit code. */
    int finish() const
    {
        std::printf("%d passed, %d failed\n", passed, failed);
        return failed == 0 && passed > 0 ? 0 : 1;
    }
};

/* The q-quantile (0 < q <= 1) of values, which it reorders; 0 if there are none. NaN sorts last. */
inline double quantile(std::vector<double> &values, double q)
{
    if (values.empty())
        return 0;
    double rank = std::ceil(q * (double)values.size());
    size_t index = (size_t)std::max(rank - 1, 0.0);
    std::nth_element(values.begin(), values.begin() + (std::ptrdiff_t)index, values.end(),
                     [](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a < b; });
    return values[index];
}

#endif
