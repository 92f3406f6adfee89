#include "server/curves/fields/line_set.h"

#include <string.h>

void line_set_signs(const struct line_set *set, struct vec x, struct vec n,
                    struct line_signs *signs)
{
    memset(signs, 0, sizeof *signs);
    struct bezier_jet at = {.n = {n}}; /* relative to x itself */
    for (uint32_t f = 0; f < set->n_fields; f++) {
        struct field_nets bounds;
        field_find_bounds(&set->field[f], x, 0, &bounds);
        for (uint32_t i = set->first_line[f]; i < set->first_line[f + 1]; i++) {
            double jet[3];
            field_jet(&set->field[f], &set->line[i], x, &at, jet);
            if (jet[0] < -LINE_NOISE * field_bound(&bounds, &set->line[i]))
                line_sign_flip(signs, i);
        }
    }
}
