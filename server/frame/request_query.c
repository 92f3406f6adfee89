/* The reply to MODEL_QUERY: a model's description. */
#include <stdio.h>
#include <string.h>

#include "protocol/messages/message_values.h"
#include "server/assets/model_file.h"
#include "server/frame/request_internal.h"
#include "server/scene/scene_convert.h"

static void fill_statistics(sheen_ModelInfo *info, const struct cage_statistics *statistics)
{
    _Static_assert(CAGE_MAX_VALENCES == sizeof info->extraordinary / sizeof *info->extraordinary,
                   "the numbers fit the message");
    info->has_patches = statistics->n_patches > 0;
    info->patches = statistics->n_patches;
    info->triangles = statistics->n_triangles;
    info->quads = statistics->n_quads;
    info->ngons = statistics->n_ngons;
    info->boundary_edges = statistics->n_boundary_edges;
    info->boundary_extraordinary = statistics->n_boundary_extraordinary;
    info->sharp_edges = statistics->n_sharp_edges;
    info->semisharp_edges = statistics->n_semisharp_edges;
    info->sharp_vertices = statistics->n_sharp_vertices;
    info->holes = statistics->n_holes;
    info->nonmanifold_edges = statistics->n_nonmanifold_edges;
    info->nonmanifold_vertices = statistics->n_nonmanifold_vertices;
    info->extraordinary_count = (pb_size_t)statistics->n_valences;
    for (uint32_t i = 0; i < statistics->n_valences; i++)
        info->extraordinary[i] = (sheen_ValenceCount){statistics->extraordinary[i].valence,
                                                      statistics->extraordinary[i].count};
}

/* The protocol numbers the kinds of findings as the cage does. */
static void fill_findings(sheen_ModelInfo *info, const struct model *model)
{
    _Static_assert(N_CAGE_FINDINGS <= sizeof info->findings / sizeof *info->findings,
                   "all kinds fit the message");
    _Static_assert((int)CAGE_FOUND_INSIDE_OUT == (int)sheen_FindingKind_FINDING_INSIDE_OUT,
                   "the last kind here and there");
    info->findings_count = (pb_size_t)model->n_findings;
    for (size_t i = 0; i < model->n_findings; i++) {
        const struct cage_finding *finding = &model->finding[i];
        info->findings[i] = (sheen_Finding){
            .kind = (sheen_FindingKind)finding->kind,
            .count = finding->count,
            .has_line = finding->line != 0,
            .line = finding->line,
            .has_face = finding->face != CAGE_NO_FACE,
            .face = finding->face,
        };
    }
}

void request_reply_query(struct request *request)
{
    const struct asset *asset = request->model.asset;
    const struct model *model = asset->model;
    const struct limit_tables *tables = &model->tables;
    sheen_ModelInfo info = {
        .file_bytes = asset->file_bytes,
        .vertices = (uint32_t)model->n_vertices,
        .faces = (uint32_t)model->n_faces,
        .ptex_faces = (uint32_t)tables->n_faces,
        .regular_patches = (uint32_t)tables->count[LIMIT_REGULAR],
        .corner_patches = (uint32_t)tables->count[LIMIT_CORNER],
        .strip_patches = (uint32_t)tables->count[LIMIT_STRIP],
        .split_nodes = (uint32_t)tables->count[LIMIT_SPLIT],
        .hole_nodes = (uint32_t)tables->count[LIMIT_HOLE],
        .table_bytes = limit_tables_bytes(tables),
        .regular_bytes = limit_face_bytes(tables, LIMIT_REGULAR),
        .corner_bytes = limit_face_bytes(tables, LIMIT_CORNER),
        .tables_us = model->build_us,
        .box_min = message_vec3(tables->box_min),
        .box_max = message_vec3(tables->box_max),
    };
    memcpy(info.sha256, asset->sha256, sizeof info.sha256);
    snprintf(info.name, sizeof info.name, "%s", asset->name);
    snprintf(info.warnings, sizeof info.warnings, "%s", model->warnings ? model->warnings : "");
    message_make_text(info.warnings, true);
    fill_statistics(&info, &model->statistics);
    fill_findings(&info, model);
    request->client->events->answered(request->client->owner, request->reply, MESSAGE_MODEL_INFO,
                                      &info);
    request_end(request);
}

static void file_loaded(void *owner, const uint8_t *sha256, const struct error *error)
{
    struct request *request = owner;
    request->host->n_file_loads--;
    if (!sha256)
        request->failure = *error;
    else if (request->state != REQUEST_ABANDONED) /* an abandoned request needs no model */
        request_acquire(request, &request->model, ASSET_MODEL, sha256);
    request_stop_awaiting(request);
}

void request_load_file(struct request *request, const char *name)
{
    struct request_host *host = request->host;
    const struct model_file_order order = {
        .folder_fd = host->models_fd,
        .name = name,
        .max_bytes = host->max_file_bytes,
        .holder = request->asker,
        .pool = host->pool,
        .store = host->store,
        .loaded = file_loaded,
        .owner = request,
    };
    if (host->models_fd < 0)
        error_set(&request->failure, ERROR_REQUEST,
                  "this daemon has no model files of its own; sheend --models gives it some");
    else if (model_file_load(&order, &request->failure)) {
        request->n_awaited++;
        host->n_file_loads++;
    }
}
