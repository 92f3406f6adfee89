/* A wavy sheet of quads over [0, columns/rows] x [0, 1] with extraordinary vertices inside: about
 * every `every`-th edge is turned, which makes two vertices of valence 3 and two of valence 5. */
#ifndef SHEEN_TESTS_BENCH_SHEET_H
#define SHEEN_TESTS_BENCH_SHEET_H

#include <memory>

#include "tests/oracle/renderer.h"
#include "tests/oracle/cage_file.h"

class sheet
{
  public:
    /* every: one turned edge for this many faces; 0: none. */
    sheet(int columns, int rows, int every);
    std::shared_ptr<const struct cage> cage() const;
    void write_obj(const std::string &path) const
    {
        loose.write_obj(path);
    }
    size_t irregular() const /* interior vertices */
    {
        return 4 * turned;
    }
    /* Looks from this distance above an interior vertex of valence 5, or above the place where one
     * would be. */
    void close_up(double distance, camera *camera) const;
    /* Looks from above, so near that the sheet more than covers a square picture. */
    void fill_view(camera *camera) const;

  private:
    static void look_down(vec3 place, double distance, camera *camera);
    uint32_t vertex(int i, int j) const
    {
        return (uint32_t)(j * (columns + 1) + i);
    }
    void turn(int i, int j);
    int columns, rows;
    size_t turned = 0;
    loose_cage loose;
};

#endif
