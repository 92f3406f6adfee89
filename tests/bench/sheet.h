/* A rolling sheet of quads over [0, columns/rows] x [0, 1] with extraordinary vertices inside:
 * every `every`-th edge or so is turned, which makes two vertices of valence 3 and two of 5. */
#ifndef SHEEN_TESTS_BENCH_SHEET_H
#define SHEEN_TESTS_BENCH_SHEET_H

#include <memory>

#include "tests/oracle/renderer.h"
#include "tests/oracle/cage_file.h"

class sheet
{
  public:
    /* every: one turned edge for so many faces; 0: none. */
    sheet(int columns, int rows, int every);
    std::shared_ptr<const struct cage> cage() const;
    void write_obj(const std::string &path) const
    {
        loose.write_obj(path);
    }
    size_t irregular() const /* vertices inside */
    {
        return 4 * turned;
    }
    /* From so far above a vertex of valence 5 inside, or where one would be. */
    void close_up(double distance, camera *camera) const;
    /* From above, so near that the sheet covers a square picture with some to spare. */
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
