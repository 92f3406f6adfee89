#include "server/cage/read/bpt.h"

#include "server/cage/build/patch_forms.h"
#include "server/cage/read/words.h"

/* Degrees that other programs write; what sheen draws is less. */
enum { LARGEST_DEGREE = 1000 };

static bool read_degree(struct words *words, char direction, uint32_t *degree)
{
    char what[] = "the degree along ?";
    what[sizeof what - 2] = direction;
    if (!words_count(words, 1, LARGEST_DEGREE, degree, what))
        return false;
    return *degree <= PATCH_MAX_DEGREE ||
           words_fail(words,
                      "a patch of degree %u along %c: sheen draws Bezier patches of degree 1 to %d",
                      *degree, direction, PATCH_MAX_DEGREE);
}

static bool read_patch(struct words *words, struct cage_builder *builder)
{
    uint32_t m, n;
    double points[16][3];
    struct cage_patch patch = {.basis = CAGE_BEZIER};
    if (!read_degree(words, 'u', &m))
        return false;
    patch.line = words->line;
    if (!read_degree(words, 'v', &n) ||
        !words_points(words, points, (size_t)(m + 1) * (n + 1), "point"))
        return false;
    patch_from_bezier((const double(*)[3])points, m, n, patch.point);
    return cage_builder_patch(builder, &patch, words->error);
}

static bool read_all(struct words *words, struct cage_builder *builder)
{
    uint32_t n_patches;
    struct obj_field more;
    if (!words_count(words, 1, CAGE_MAX_PATCHES, &n_patches, "the number of patches"))
        return false;
    for (uint32_t i = 0; i < n_patches; i++)
        if (!read_patch(words, builder))
            return false;
    return !words_next(words, &more) ||
           words_fail(words, "more follows after the last of %u patches: '%.*s'", n_patches,
                      (int)(more.length < 40 ? more.length : 40), more.text);
}

bool bpt_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error)
{
    struct words words;
    bool ok = words_init(&words, bytes, size, name, ".bpt", error) && read_all(&words, builder);
    words_finish(&words);
    return ok;
}
