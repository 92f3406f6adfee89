/* sheen info: what a model is and costs. */
#include <inttypes.h>
#include <stdio.h>

#include "client/cli/commands.h"
#include "client/cli/client.h"
#include "client/cli/options/values.h"

static void print_findings(struct json *json, const struct sheen_model_info *info)
{
    static const char *const KINDS[] = {
        [SHEEN_FINDING_REPEATED_CORNER] = "repeated-corner",
        [SHEEN_FINDING_FEW_CORNERS] = "few-corners",
        [SHEEN_FINDING_KEYHOLE] = "keyhole",
        [SHEEN_FINDING_CREASE_WITHOUT_EDGE] = "crease-without-edge",
        [SHEEN_FINDING_CORNER_WITHOUT_VERTEX] = "corner-without-vertex",
        [SHEEN_FINDING_HOLE_WITHOUT_FACE] = "hole-without-face",
        [SHEEN_FINDING_UNWELDED] = "unwelded",
        [SHEEN_FINDING_TRIANGLES] = "triangles",
        [SHEEN_FINDING_WOUND_AGAINST] = "wound-against",
        [SHEEN_FINDING_FACE_TWICE] = "face-twice",
        [SHEEN_FINDING_INSIDE_OUT] = "inside-out",
        [SHEEN_FINDING_OTHER] = "other",
    };
    json_array_begin(json, "findings");
    for (uint32_t i = 0; i < info->n_findings; i++) {
        const struct sheen_finding *finding = &info->findings[i];
        json_object_begin(json, NULL);
        json_text(json, "kind",
                  (size_t)finding->kind < sizeof(KINDS) / sizeof(*KINDS) ? KINDS[finding->kind]
                                                                         : "other");
        json_uint(json, "count", finding->count);
        if (finding->line)
            json_uint(json, "line", finding->line);
        if (finding->has_face)
            json_uint(json, "face", finding->face);
        json_object_end(json);
    }
    json_array_end(json);
}

static void print_json(struct json *json, const struct sheen_model_info *info,
                       const struct sheen_server *server)
{
    const struct {
        const char *key;
        uint64_t value;
    } numbers[] = {
        {"file_bytes", info->file_bytes},
        {"vertices", info->vertices},
        {"faces", info->faces},
        {"triangles", info->triangles},
        {"quads", info->quads},
        {"ngons", info->ngons},
        {"ptex_faces", info->ptex_faces},
        {"boundary_edges", info->boundary_edges},
        {"boundary_extraordinary", info->boundary_extraordinary},
        {"sharp_edges", info->sharp_edges},
        {"semisharp_edges", info->semisharp_edges},
        {"sharp_vertices", info->sharp_vertices},
        {"holes", info->holes},
        {"patches", info->patches},
        {"nonmanifold_edges", info->nonmanifold_edges},
        {"nonmanifold_vertices", info->nonmanifold_vertices},
        {"regular_patches", info->regular_patches},
        {"corner_patches", info->corner_patches},
        {"strip_patches", info->strip_patches},
        {"split_nodes", info->split_nodes},
        {"hole_nodes", info->hole_nodes},
        {"table_bytes", info->table_bytes},
        {"regular_bytes", info->regular_bytes},
        {"corner_bytes", info->corner_bytes},
        {"tables_us", info->tables_us},
    };
    json_object_begin(json, NULL);
    json_hex(json, "sha256", info->id, SHEEN_ID_BYTES);
    json_text(json, "name", info->name);
    for (size_t i = 0; i < sizeof(numbers) / sizeof(*numbers); i++)
        json_uint(json, numbers[i].key, numbers[i].value);
    json_array_begin(json, "extraordinary");
    for (uint32_t i = 0; i < info->n_valences; i++) {
        json_object_begin(json, NULL);
        json_uint(json, "valence", info->extraordinary[i].valence);
        json_uint(json, "count", info->extraordinary[i].count);
        json_object_end(json);
    }
    json_array_end(json);
    json_vec3(json, "box_min", info->box_min);
    json_vec3(json, "box_max", info->box_max);
    json_text(json, "device", server->device);
    json_text(json, "driver", server->driver);
    json_bool(json, "software", server->software);
    json_lines(json, "warnings", info->warnings);
    print_findings(json, info);
    json_object_end(json);
}

struct count {
    uint32_t number;
    const char *one, *many; /* the noun for one and for many, and what follows it */
};

/* Prints a list of counts, which ends with an entry without a noun. */
static void print_counts(const char *title, const struct count *counts)
{
    printf("%-16s ", title);
    for (; counts->one; counts++)
        printf("%u %s", counts->number, value_noun(counts->number, counts->one, counts->many));
    putchar('\n');
}

static void print_cage(const struct sheen_model_info *info)
{
    print_counts("cage", (const struct count[]){{info->vertices, "vertex, ", "vertices, "},
                                                {info->faces, "face: ", "faces: "},
                                                {info->triangles, "triangle, ", "triangles, "},
                                                {info->quads, "quad, ", "quads, "},
                                                {info->ngons, "larger", "larger"},
                                                {0}});
}

/* What only a cage has: extraordinary vertices and sharpness. */
static void print_rules(const struct sheen_model_info *info)
{
    printf("%-16s", "extraordinary");
    for (uint32_t i = 0; i < info->n_valences; i++)
        printf("%s %u of valence %u", i ? "," : "", info->extraordinary[i].count,
               info->extraordinary[i].valence);
    printf("%s\n", info->n_valences ? "" : " none inside");
    print_counts(
        "sharpness",
        (const struct count[]){{info->sharp_edges, "sharp and ", "sharp and "},
                               {info->semisharp_edges, "semi-sharp edge, ", "semi-sharp edges, "},
                               {info->sharp_vertices, "vertex, ", "vertices, "},
                               {info->holes, "hole", "holes"},
                               {0}});
}

static void print_table(const struct sheen_model_info *info, const struct sheen_server *server)
{
    printf("%-16s %s\n%-16s ", "name", info->name, "sha256");
    for (size_t i = 0; i < SHEEN_ID_BYTES; i++)
        printf("%02x", info->id[i]);
    printf("\n%-16s %" PRIu64 " bytes\n", "file", info->file_bytes);
    if (info->patches)
        print_counts("patches", (const struct count[]){{info->patches, "bicubic", "bicubic"}, {0}});
    else
        print_cage(info);
    printf("%-16s %.9g %.9g %.9g to %.9g %.9g %.9g\n", "box", info->box_min[0], info->box_min[1],
           info->box_min[2], info->box_max[0], info->box_max[1], info->box_max[2]);
    print_counts("boundary",
                 (const struct count[]){{info->boundary_edges, "edge, ", "edges, "},
                                        {info->boundary_extraordinary, "extraordinary vertex",
                                         "extraordinary vertices"},
                                        {0}});
    if (!info->patches)
        print_rules(info);
    if (info->nonmanifold_edges || info->nonmanifold_vertices)
        print_counts("non-manifold",
                     (const struct count[]){{info->nonmanifold_edges, "edge, ", "edges, "},
                                            {info->nonmanifold_vertices, "vertex", "vertices"},
                                            {0}});
    print_counts("ptex",
                 (const struct count[]){{info->ptex_faces, "face: ", "faces: "},
                                        {info->regular_patches, "regular, ", "regular, "},
                                        {info->corner_patches, "corner and ", "corner and "},
                                        {info->strip_patches, "strip patch, ", "strip patches, "},
                                        {info->split_nodes, "split, ", "split, "},
                                        {info->hole_nodes, "without surface", "without surface"},
                                        {0}});
    printf("%-16s %" PRIu64 " bytes %s: %" PRIu64 " a regular patch, %" PRIu64
           " a corner patch at most\n",
           "tables", info->table_bytes, client_place_of_tables(server->software),
           info->regular_bytes, info->corner_bytes);
    printf("%-16s %.1f ms\n", "built in", (double)info->tables_us / 1e3);
    printf("%-16s %s (%s)\n", "device", server->device, server->driver);
}

static enum sheen_status ask(struct client *client, struct sheen_model_info *info,
                             struct sheen_server *server)
{
    enum sheen_status status =
        sheen_query_model(client->session, client->model_id, &client->report, info, &client->error);
    return status ? status : sheen_get_server(client->session, server, &client->error);
}

static int run(const struct options *options)
{
    struct client client;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    struct sheen_server server = SHEEN_SERVER_DEFAULTS;
    enum sheen_status status = client_init(&client, options);
    if (!status)
        status = ask(&client, &info, &server);
    while (status && client_resume(&client, options, &status))
        status = ask(&client, &info, &server);
    progress_clear(&client.progress);
    if (!status && !options->quiet)
        client_print_warnings(&client, info.warnings);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        print_json(&json, &info, &server);
        status = client_finish_json(&client, &json);
    } else if (!status) {
        print_table(&info, &server);
    }
    return client_finish(&client, status);
}

static const struct option_row *const TABLES[] = {OPTIONS_MODEL, OPTIONS_COMMON, OPTIONS_RECONNECT,
                                                  OPTIONS_OUTPUT, NULL};

const struct command COMMAND_INFO = {
    .name = "info",
    .arguments = "MODEL [option]...",
    .summary =
        "Describes a model: its cage or patches, probable mistakes, and the memory of its tables.",
    .tables = TABLES,
    .examples = "  sheen info hood.obj\n"
                "  sheen info hood.obj --json\n"
                "  sheen info hood.obj --weld\n",
    .takes_model = true,
    .codes = CODE_FILES | CODE_SERVER,
    .run = run,
};
