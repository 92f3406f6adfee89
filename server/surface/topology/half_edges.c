#include "server/surface/topology/half_edges.h"

struct sector topology_sector(const struct topology *t, uint32_t corner)
{
    struct sector sector = {corner, 1, 0, false};
    uint32_t lowest = corner, to_lowest = 0;
    for (uint32_t c = corner_cw(t, corner); c != CORNER_NONE; c = corner_cw(t, c)) {
        if (c == corner)
            return (struct sector){lowest, sector.n_faces, to_lowest, true};
        sector.first = c;
        sector.at++;
        sector.n_faces++;
        if (c < lowest) {
            lowest = c;
            to_lowest = sector.at;
        }
    }
    for (uint32_t c = corner_ccw(t, corner); c != CORNER_NONE; c = corner_ccw(t, c))
        sector.n_faces++;
    return sector;
}
