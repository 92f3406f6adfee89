#include "server/curves/fields/line_set.h"

#include <string.h>

/* Adds a line to the last field if that is the line's, else to a new one. */
static enum line_set_result add(struct line_set *set, const struct line_field *field,
                                uint16_t light, const struct field_line *line)
{
    uint32_t n = set->n_lines;
    bool is_same =
        n > 0 && set->light[n - 1] == light && set->field[set->n_fields - 1].form == field->form;
    if (n == LINE_SET_MOST_LINES || (!is_same && set->n_fields == LINE_SET_MOST_FIELDS))
        return LINE_SET_FULL;
    if (!is_same)
        set->field[set->n_fields++] = *field;
    set->line[n] = *line;
    set->light[n] = light;
    set->n_lines++;
    set->first_line[set->n_fields] = set->n_lines;
    return LINE_ADDED;
}

enum line_set_result line_set_add(struct line_set *set, const struct line_map *map, uint16_t light,
                                  double place)
{
    struct line_field field;
    struct field_line line;
    if (!line_field_init(&field, map))
        return LINE_NO_CURVE;
    if (!field_line_init(&field, place, &line))
        return LINE_NOT_THERE;
    return add(set, &field, light, &line);
}

enum line_set_result line_set_add_silhouette(struct line_set *set, const struct line_map *map)
{
    struct line_field field;
    struct field_line line;
    silhouette_field_init(&field, map);
    field_line_init(&field, 0, &line);
    return add(set, &field, 0, &line);
}

const struct line_field *line_set_field(const struct line_set *set, uint32_t line)
{
    uint32_t f = 0;
    while (set->first_line[f + 1] <= line)
        f++;
    return &set->field[f];
}

void line_set_signs(const struct line_set *set, struct vec x, struct vec n,
                    struct line_signs *signs)
{
    memset(signs, 0, sizeof *signs);
    struct bezier_jet at = {.n = {n}}; /* relative to x itself */
    for (uint32_t f = 0; f < set->n_fields; f++) {
        struct field_bounds bounds;
        field_find_bounds(&set->field[f], x, 0, &bounds);
        for (uint32_t i = set->first_line[f]; i < set->first_line[f + 1]; i++) {
            double jet[3];
            field_jet(&set->field[f], &set->line[i], x, &at, jet);
            if (jet[0] < -LINE_NOISE * field_bound(&bounds, &set->line[i]))
                line_sign_flip(signs, i);
        }
    }
}
