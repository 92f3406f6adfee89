/* Every level of libosd's uniform refinement of a cage, in double precision. */
#ifndef SHEEN_TESTS_ORACLE_OSD_LEVELS_H
#define SHEEN_TESTS_ORACLE_OSD_LEVELS_H

#include <memory>

#include "tests/oracle/vec.h"

extern "C" {
#include "server/cage/cage.h"
}

class osd_levels
{
  public:
    /* Throws std::runtime_error as osd_oracle does. */
    osd_levels(const cage &cage, int n_levels);
    ~osd_levels();
    osd_levels(const osd_levels &) = delete;
    osd_levels &operator=(const osd_levels &) = delete;

    /* The faces of level 0 are those of the cage. */
    /* The face of the next level at this corner. */
    int child(int level, int face, int corner) const;
    vec3 vertex(int level, int face, int corner) const;

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

#endif
