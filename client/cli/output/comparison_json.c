/* The result of `sheen compare` as JSON: client/schema/compare-1.json. */
#include <math.h>

#include "client/cli/output/comparison.h"
#include "client/cli/output/scene_json.h"

#define SCHEMA "sheen-compare-1"

static void write_place(struct json *json, const char *key,
                        const struct sheen_compared_place *place)
{
    json_object_begin(json, key);
    json_uint(json, "face", place->face);
    json_double(json, "u", place->uv[0]);
    json_double(json, "v", place->uv[1]);
    json_vec3(json, "position", place->position);
    json_object_end(json);
}

static void write_measure(struct json *json, const char *key,
                          const struct sheen_compared_measure *measure)
{
    if (!measure->is_known) {
        json_double(json, key, (double)NAN); /* null */
        return;
    }
    json_object_begin(json, key);
    json_double(json, "worst", measure->worst);
    json_double(json, "rms", measure->rms);
    json_double(json, "p95", measure->p95);
    json_double(json, "p99", measure->p99);
    json_double(json, "area_out", measure->area_out);
    write_place(json, "old", &measure->at[0]);
    write_place(json, "new", &measure->at[1]);
    json_object_end(json);
}

static void write_side(struct json *json, const char *key, const struct sheen_compared_side *side)
{
    json_object_begin(json, key);
    json_uint(json, "samples", side->samples);
    json_double(json, "area", side->area);
    json_double(json, "uncovered_area", side->area_uncovered);
    if (side->has_uncovered)
        write_place(json, "uncovered_at", &side->uncovered);
    json_double(json, "rewound_area", side->area_rewound);
    json_double(json, "unlit_area", side->area_unlit);
    for (int k = 0; k < SHEEN_N_COMPARE_MEASURES; k++)
        write_measure(json, comparison_key((enum comparison_item)k), &side->measures[k]);
    json_object_end(json);
}

static void write_item(struct json *json, const struct compared_pair *pair,
                       enum comparison_item item)
{
    const struct comparison_limit *limit = &pair->limits[item];
    json_object_begin(json, comparison_key(item));
    json_double(json, "worst", comparison_value(pair, item));
    json_double(json, "limit", limit->is_off ? (double)NAN : limit->value);
    json_bool(json, "default", !limit->is_given);
    json_double(json, "share_allowed", limit->share);
    json_double(json, "share_out", comparison_share_out(pair, item));
    json_bool(json, "out", pair->out >> item & 1);
    json_object_end(json);
}

static void write_file(struct json *json, const char *key, const struct compared_pair *pair, int k)
{
    if (!pair->files[k])
        return;
    json_object_begin(json, key);
    json_text(json, "file", pair->files[k]);
    if (comparison_is_made(pair))
        json_hex(json, "sha256", pair->ids[k], SHEEN_ID_BYTES);
    json_object_end(json);
}

static void write_alignment(struct json *json, const struct sheen_comparison *comparison)
{
    json_object_begin(json, "alignment");
    json_array_begin(json, "rotation");
    for (int k = 0; k < 3; k++)
        json_vec3(json, NULL, comparison->rotation + 3 * k);
    json_array_end(json);
    json_vec3(json, "shift", comparison->shift);
    json_double(json, "rotation_deg", comparison->rotation_deg);
    json_double(json, "rms_before", comparison->rms_before);
    json_double(json, "rms_after", comparison->rms_after);
    json_uint(json, "free_directions", comparison->free_directions);
    json_object_end(json);
}

static const char *verdict_of(const struct compared_pair *pair)
{
    bool is_within = pair->verdict == COMPARISON_SAME && !comparison_is_identical(pair);
    return is_within ? "within_limits" : comparison_verdict_name(pair->verdict);
}

static bool are_identical(const struct compared_pair *pairs, size_t n)
{
    size_t n_identical = 0;
    for (size_t i = 0; i < n; i++)
        n_identical += comparison_is_identical(&pairs[i]);
    return n_identical == n;
}

static void write_comparison(struct json *json, const struct compared_pair *pair)
{
    const struct sheen_comparison *comparison = &pair->comparison;
    json_bool(json, "within_limits", pair->verdict == COMPARISON_SAME);
    json_bool(json, "identical", comparison_is_identical(pair));
    json_text(json, "unit", pair->has_unit ? "m" : "the file's own");
    json_double(json, "diagonal", comparison->diagonal);
    json_object_begin(json, "floor");
    json_double(json, "distance", comparison->distance_floor);
    json_double(json, "normal_deg", comparison->normal_floor_deg);
    json_object_end(json);
    json_bool(json, "rewound", comparison->is_rewound);
    json_object_begin(json, "measures");
    for (int k = 0; k < COMPARISON_ITEMS; k++)
        write_item(json, pair, (enum comparison_item)k);
    json_object_end(json);
    write_side(json, "old_samples", &comparison->sides[0]);
    write_side(json, "new_samples", &comparison->sides[1]);
    if (comparison->is_aligned)
        write_alignment(json, comparison);
    scene_json_lines(json, &comparison->camera, &comparison->lines, comparison->lights,
                     comparison->n_lights);
    json_uint(json, "total_us", comparison->total_us);
    json_text(json, "server", comparison->server);
}

static void write_failure(struct json *json, const struct compared_pair *pair)
{
    json_object_begin(json, "error");
    if (pair->failed_side >= 0)
        json_text(json, "side", pair->failed_side ? "new" : "old");
    json_uint(json, "code", (uint64_t)sheen_status_exit_code(pair->status));
    json_text(json, "text", pair->failure);
    json_object_end(json);
}

void comparison_write_json(struct json *json, const struct compared_pair *pairs, size_t n)
{
    const char *verdict = comparison_count(pairs, n, COMPARISON_FAILED)     ? "failed"
                          : comparison_count(pairs, n, COMPARISON_SAME) < n ? "differs"
                          : are_identical(pairs, n)                         ? "same"
                                                                            : "within_limits";
    json_object_begin(json, NULL);
    json_text(json, "schema", SCHEMA);
    json_text(json, "verdict", verdict);
    json_array_begin(json, "pairs");
    for (size_t i = 0; i < n; i++) {
        json_object_begin(json, NULL);
        json_text(json, "name", pairs[i].name);
        json_text(json, "verdict", verdict_of(&pairs[i]));
        write_file(json, "old", &pairs[i], 0);
        write_file(json, "new", &pairs[i], 1);
        if (pairs[i].verdict == COMPARISON_FAILED)
            write_failure(json, &pairs[i]);
        if (comparison_is_made(&pairs[i]))
            write_comparison(json, &pairs[i]);
        json_object_end(json);
    }
    json_array_end(json);
    json_object_end(json);
}
