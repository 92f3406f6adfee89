/* server/curves/line_position.h for oracle tests: its headers and lines.h use the same names, so that no file can
 * include both. */
#ifndef SHEEN_TESTS_ORACLE_PRODUCT_LINES_H
#define SHEEN_TESTS_ORACLE_PRODUCT_LINES_H

#include <memory>

#include "tests/oracle/vec.h"

/* Families, lights and patterns have the numbers of lines.h. */
struct product_setup {
    int family, light_kind, pattern_kind;
    bool has_axis, eye_is_point, one_sided;
    vec3 axis, eye, centre, u, v;
    double count, period, rotation_deg;
};

struct product_place {
    bool met, known;
    double s, t, tau, sine;
};

class product_lines
{
  public:
    explicit product_lines(const product_setup &setup);
    ~product_lines();
    product_lines(const product_lines &) = delete;
    product_lines &operator=(const product_lines &) = delete;

    product_place at(vec3 x, vec3 n) const;
    double shift(const product_place &from, const product_place &to) const;
    double density(vec3 x, vec3 n, const vec3 along[2], const vec3 turn[2]) const;

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

#endif
