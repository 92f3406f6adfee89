#include "server/surface/regular.h"

#include <string.h>

#include "server/surface/bound.h"
#include "server/surface/texels.h"

struct vec regular_centre(struct vec grid[16])
{
    struct vec centre = {0, 0, 0};
    for (int k = 0; k < 16; k++)
        centre = vec_mad(centre, 1.0 / 16, grid[k]);
    for (int k = 0; k < 16; k++)
        grid[k] = vec_sub(grid[k], centre);
    return centre;
}

struct vec regular_corner_point(const struct vec grid[16], int x, int y)
{
    static const double weight[3] = {1.0 / 6, 2.0 / 3, 1.0 / 6};
    struct vec sum = {0, 0, 0};
    for (int k = 0; k < 9; k++)
        sum =
            vec_mad(sum, weight[k / 3] * weight[k % 3], grid[4 * (y + k / 3 - 1) + x + k % 3 - 1]);
    return sum;
}

void regular_write_corner(struct limit_head *head, int corner, struct vec p)
{
    head->corner[0][corner] = (float)p.x;
    head->corner[1][corner] = (float)p.y;
    head->corner[2][corner] = (float)p.z;
}

/* The radius of a bound also contains the corners' rounded coordinates. */
void regular_write_head(struct limit_tables *tables, uint32_t node, const struct vec first[16],
                        const struct vec last[16])
{
    struct limit_head *head = &tables->heads[node];
    memset(head->frame, 0, sizeof head->frame);
    head->frame[3] = 1;
    for (int k = 0; k < 4; k++)
        regular_write_corner(
            head, k, regular_corner_point(k < 2 ? first : last, k & 1 ? 2 : 1, k < 2 ? 1 : 2));
}

void regular_write(struct limit_tables *tables, uint32_t node, struct vec grid[16], uint32_t texel)
{
    struct limit_node *out = &tables->nodes[node];
    struct vec centre = regular_centre(grid);
    out->kind = LIMIT_REGULAR;
    out->origin[0] = centre.x;
    out->origin[1] = centre.y;
    out->origin[2] = centre.z;
    out->first = texel;
    tables->whole[node] = bound_of_grid(grid, 4, false, true);
    regular_write_head(tables, node, grid, grid);
    if (tables->texels)
        texels_write_patch(grid, tables->texels + texel);
}
