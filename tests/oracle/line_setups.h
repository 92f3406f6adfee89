/* The families, lights, patterns and line eyes that test_lines combines for a view. */
#ifndef SHEEN_TESTS_ORACLE_LINE_SETUPS_H
#define SHEEN_TESTS_ORACLE_LINE_SETUPS_H

#include <string>
#include <vector>

#include "tests/oracle/lines.h"
#include "tests/oracle/model.h"

struct named_setup {
    std::string name;
    line_setup setup;
    /* True if the lines stay on the surface when the camera moves. */
    bool locked() const
    {
        return setup.eye_kind != line_eye_kind::camera;
    }
};

/* All setups of a view: every family and light at least twice, every pattern, one and several
 * lights. */
std::vector<named_setup> line_setups(const model &model, const view &view);

#endif
