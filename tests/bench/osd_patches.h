/* A cage as OpenSubdiv's users draw it: libosd's own choices, Gregory end caps, and the points that
 * its patches index. */
#ifndef SHEEN_TESTS_BENCH_OSD_PATCHES_H
#define SHEEN_TESTS_BENCH_OSD_PATCHES_H

#include <memory>
#include <vector>

#include <opensubdiv/far/patchTable.h>

#include "tests/oracle/osd_refiner.h"

struct osd_patches {
    std::unique_ptr<OpenSubdiv::Far::PatchTable> table;
    std::vector<control_point> points;

    /* `level`: how deep features are isolated. Throws as make_refiner() does. */
    osd_patches(const cage &cage, int level);
};

#endif
