/* All lines that are traced together, and their signs at places of the surface. Plain data of the
 * caller; any thread. */
#ifndef SHEEN_FIELDS_LINE_SET_H
#define SHEEN_FIELDS_LINE_SET_H

#include <stdint.h>

#include "server/curves/fields/crossings.h"

enum { LINE_SET_MOST_FIELDS = 33, LINE_SET_MOST_LINES = 1024 };
enum { LINE_SET_WORDS = LINE_SET_MOST_LINES / 64 };

/* Lines are numbered field by field: the first of field f is first_line[f], and the one after its
 * last is first_line[f + 1]. */
struct line_set {
    uint32_t n_fields, n_lines;
    struct line_field field[LINE_SET_MOST_FIELDS];
    uint32_t first_line[LINE_SET_MOST_FIELDS + 1];
    struct field_line line[LINE_SET_MOST_LINES];
    uint16_t light[LINE_SET_MOST_LINES]; /* of each line; what the caller calls it */
};

enum line_set_result {
    LINE_ADDED,
    LINE_NOT_THERE, /* the light has no such place */
    LINE_NO_CURVE,  /* the lines have no F (line_field_init()) */
    LINE_SET_FULL,
};
/* Adds the line at `place` of a light. Lines of one light come one after the other. */
enum line_set_result line_set_add(struct line_set *set, const struct line_map *map, uint16_t light,
                                  double place);
/* Adds the silhouette for the eye of `map`. */
enum line_set_result line_set_add_silhouette(struct line_set *set, const struct line_map *map);
/* The field of a line. */
const struct line_field *line_set_field(const struct line_set *set, uint32_t line);

/* A bit for each line: 1 where F is negative. */
struct line_signs {
    uint64_t word[LINE_SET_WORDS];
};

static inline bool line_sign(const struct line_signs *signs, uint32_t line)
{
    return signs->word[line / 64] >> (line % 64) & 1;
}

static inline void line_sign_flip(struct line_signs *signs, uint32_t line)
{
    signs->word[line / 64] ^= (uint64_t)1 << (line % 64);
}

/* The signs at the surface point x (world) with the unit normal n. */
void line_set_signs(const struct line_set *set, struct vec x, struct vec n,
                    struct line_signs *signs);

#endif
