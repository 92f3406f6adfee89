#include "server/curves/lines/sides.h"

#include <math.h>
#include <stdlib.h>

void root_list_add(struct sides_work *work, struct root_list *list, struct side_root root)
{
    if (list->n == list->room) {
        size_t room = list->room ? 2 * list->room : 8;
        struct side_root *grown = realloc(list->root, room * sizeof *grown);
        if (!grown) {
            work->failed = true;
            return;
        }
        list->root = grown;
        list->room = room;
    }
    list->root[list->n++] = root;
}

void root_list_finish(struct root_list *list)
{
    free(list->root);
    *list = (struct root_list){0};
}

void root_list_part(struct sides_work *work, const struct root_list *from, double a, double b,
                    struct root_list *to)
{
    for (size_t k = 0; k < from->n; k++) {
        struct side_root root = from->root[k];
        bool is_last = b >= 1;
        if (root.t < a || (is_last ? root.t > b : root.t >= b))
            continue;
        root.t = (root.t - a) / (b - a);
        root_list_add(work, to, root);
    }
}

void root_list_reversed(struct sides_work *work, const struct root_list *from, struct root_list *to)
{
    size_t end = 0;
    for (size_t first = 0; first < from->n; first = end) {
        while (end < from->n && from->root[end].line == from->root[first].line)
            end++;
        for (size_t k = end; k > first; k--) {
            struct side_root root = from->root[k - 1];
            root.t = 1 - root.t;
            root_list_add(work, to, root);
        }
    }
}

void root_list_cross(const struct root_list *list, struct line_signs *signs)
{
    for (size_t k = 0; k < list->n; k++)
        line_sign_flip(signs, list->root[k].line);
}

void root_list_signs(const struct root_list *list, const struct line_signs *start, double t,
                     struct line_signs *signs)
{
    *signs = *start;
    for (size_t k = 0; k < list->n; k++)
        if (list->root[k].t < t)
            line_sign_flip(signs, list->root[k].line);
}

/* By insertion, because equal places keep their order and lists are short or nearly in order. */
void sides_sort(struct root_list *list)
{
    for (size_t k = 1; k < list->n; k++) {
        struct side_root root = list->root[k];
        size_t to = k;
        for (; to > 0; to--) {
            const struct side_root *before = &list->root[to - 1];
            if (before->line < root.line || (before->line == root.line && before->t <= root.t))
                break;
            list->root[to] = *before;
        }
        list->root[to] = root;
    }
}

void sides_patch(const struct sides_work *work, uint32_t node, int level, unsigned corner,
                 struct limit_patch *patch)
{
    const struct limit_node *at = &work->tables->nodes[node];
    double x = 0.5, y = 0.5;
    if (at->kind == LIMIT_CORNER) {
        x = ldexp(corner == 3 ? 0.5 : 1.5, -level);
        y = ldexp(corner == 1 ? 0.5 : 1.5, -level);
    } else if (at->kind == LIMIT_STRIP) {
        y = level > at->levels ? ldexp(0.5, -at->levels) : ldexp(1.5, -level);
    }
    limit_patch_of_level(patch, work->tables, at, level, x, y);
}

static void add(struct sides_work *work, struct root_list *list, uint32_t line, double t)
{
    root_list_add(work, list, (struct side_root){line, t, work->next_node++});
}

void sides_agree(struct sides_work *work, double t, struct line_signs *signs,
                 const struct line_signs *wanted, struct root_list *list)
{
    for (uint32_t w = 0; 64 * w < work->set->n_lines; w++) {
        uint64_t differ = signs->word[w] ^ wanted->word[w];
        for (; differ; differ &= differ - 1)
            add(work, list, 64 * w + (uint32_t)__builtin_ctzll(differ), t);
        signs->word[w] = wanted->word[w];
    }
}

/* The roots of one line on one side of a patch, which is run through from `from` to `to`. */
static void find_line(struct sides_work *work, uint32_t line, const struct crossings *side,
                      const struct patch_field *on, double from, double to,
                      struct line_signs *signs, struct root_list *list)
{
    double at[MOST_CROSSINGS];
    const struct field_line *wanted = &work->set->line[line];
    size_t n_parts = 0;
    int sign = field_quick_sign(&side->terms, wanted), n;
    bool negative[2] = {line_sign(signs, line)};
    if (sign && (sign < 0) == negative[0])
        return;
    negative[1] = patch_field_is_negative(on, wanted, side->segment.to);
    n = crossings_find(side, on, wanted, negative, at, &n_parts);
    for (int k = 0; k < n; k++) {
        add(work, list, line, from + at[k] * (to - from));
        line_sign_flip(signs, line);
    }
}

void sides_find_patch(struct sides_work *work, const struct limit_patch *patch, unsigned side,
                      double from, double to, struct line_signs *signs, struct root_list *list)
{
    const struct line_set *set = work->set;
    struct bezier bezier;
    struct segment segment;
    bezier_of_patch(&bezier, work->tables, patch);
    segment_of_bezier(&bezier, (int)side, &segment);
    if (from > to)
        segment_reverse(&segment);
    for (uint32_t f = 0; f < set->n_fields; f++) {
        struct patch_field on;
        struct crossings along;
        patch_field_init(&on, &set->field[f], &bezier);
        crossings_init(&along, &on, &segment);
        for (uint32_t i = set->first_line[f];
             i < set->first_line[f + 1] && !computation_is_cancelled(work->computation); i++)
            find_line(work, i, &along, &on, fmin(from, to), fmax(from, to), signs, list);
    }
}

/* The sides of the patches along a side of a leaf, in the order in which the side runs, between t = from and to. */
static void find_leaf(struct sides_work *work, uint32_t index, unsigned side, double from,
                      double to, struct line_signs *signs, struct root_list *list)
{
    const struct limit_node *node = &work->tables->nodes[index];
    unsigned local = (side - node->rotation) & 3;
    struct limit_patch patch;
    double length = to - from;
    if (node->kind == LIMIT_REGULAR) {
        sides_patch(work, index, 0, 0, &patch);
        sides_find_patch(work, &patch, local, from, to, signs, list);
        return;
    }
    bool is_corner = node->kind == LIMIT_CORNER;
    int last = is_corner ? work->levels[index] : node->levels + 1;
    /* The sides whose patches become smaller towards their start or end: of a CORNER 0 and 3, of a STRIP 1 and 3. */
    bool grows = local == (is_corner ? 0 : 1), shrinks = local == 3;
    if (!grows && !shrinks) {
        for (unsigned k = 0; k < (is_corner ? 2u : 1u); k++) {
            sides_patch(work, index, local == 0 ? last : 1, is_corner ? (local + k) & 3 : 0,
                        &patch);
            double a = is_corner ? 0.5 * k : 0, b = is_corner ? 0.5 * (k + 1) : 1;
            sides_find_patch(work, &patch, local, from + a * length, from + b * length, signs,
                             list);
        }
        return;
    }
    for (int k = 1; k <= last; k++) {
        int level = grows ? last + 1 - k : k;
        bool is_rest = !is_corner && level == last; /* of a STRIP: as wide as the patch before */
        double low = is_rest ? 0 : ldexp(1, -level), high = ldexp(1, 1 - level);
        double a = grows ? low : 1 - high, b = grows ? high : 1 - low;
        sides_patch(work, index, level, local == 0 ? 1 : 3, &patch);
        sides_find_patch(work, &patch, local, from + a * length, from + b * length, signs, list);
    }
}

static void find_between(struct sides_work *work, uint32_t index, unsigned side, double from,
                         double to, struct line_signs *signs, struct root_list *list)
{
    const struct limit_node *node = &work->tables->nodes[index];
    if (node->kind == LIMIT_HOLE)
        return;
    if (node->kind != LIMIT_SPLIT) {
        find_leaf(work, index, side, from, to, signs, list);
        return;
    }
    double middle = 0.5 * (from + to);
    find_between(work, node->first + side, side, from, middle, signs, list);
    find_between(work, node->first + ((side + 1) & 3), side, middle, to, signs, list);
}

void sides_find(struct sides_work *work, uint32_t node, unsigned side, struct line_signs *signs,
                const struct line_signs *end, struct root_list *list)
{
    find_between(work, node, side, 0, 1, signs, list);
    if (end)
        sides_agree(work, 1, signs, end, list);
    sides_sort(list);
}
