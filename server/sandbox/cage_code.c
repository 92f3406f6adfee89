#include "server/sandbox/cage_code.h"

#include <stdlib.h>
#include <string.h>

/* Writes the five settings of a cage, one after another. */
static void write_settings(struct sink *sink, const struct cage *cage)
{
    sink_u32(sink, (uint32_t)cage->scheme);
    sink_u32(sink, (uint32_t)cage->boundary);
    sink_u32(sink, cage->chaikin);
    sink_u32(sink, cage->smooth_triangles);
    sink_u32(sink, (uint32_t)cage->up);
}

static void write_findings(struct sink *sink, const struct cage *cage)
{
    sink_u32(sink, (uint32_t)cage->n_findings);
    for (size_t i = 0; i < cage->n_findings; i++) {
        sink_u32(sink, (uint32_t)cage->finding[i].kind);
        sink_u32(sink, cage->finding[i].count);
        sink_u32(sink, cage->finding[i].line);
        sink_u32(sink, cage->finding[i].face);
    }
}

void cage_write(struct sink *sink, const struct cage *cage)
{
    const size_t n_face_vertices = cage->face_start[cage->n_faces];
    write_settings(sink, cage);
    sink_text(sink, cage->warnings);
    sink_u64(sink, cage->n_vertices);
    sink_bytes(sink, cage->position, cage->n_vertices * sizeof *cage->position);
    sink_u64(sink, cage->n_faces);
    sink_bytes(sink, cage->face_start, (cage->n_faces + 1) * sizeof *cage->face_start);
    sink_u64(sink, n_face_vertices);
    sink_bytes(sink, cage->face_vertex, n_face_vertices * sizeof *cage->face_vertex);
    sink_u64(sink, cage->n_creases);
    sink_bytes(sink, cage->crease, cage->n_creases * sizeof *cage->crease);
    sink_u64(sink, cage->n_corners);
    sink_bytes(sink, cage->corner, cage->n_corners * sizeof *cage->corner);
    sink_u64(sink, cage->n_holes);
    sink_bytes(sink, cage->hole, cage->n_holes * sizeof *cage->hole);
    sink_u64(sink, cage->n_patches);
    sink_bytes(sink, cage->patch, cage->n_patches * sizeof *cage->patch);
    write_findings(sink, cage);
}

/* Distinguishes lack of memory from missing bytes. */
struct taking {
    struct source *source;
    bool no_memory;
};

/* Reads a count n, which is stored first, into *count, then returns a malloc'd copy of the n +
 * extra elements that follow. */
static void *take_array(struct taking *taking, size_t *count, size_t extra, size_t element_bytes)
{
    struct source *source = taking->source;
    uint64_t n = source_u64(source);
    if (n > source->left / element_bytes || n + extra > source->left / element_bytes)
        source->ok = false;
    const size_t size = source->ok ? (n + extra) * element_bytes : 0;
    const void *bytes = source_bytes(source, size);
    void *array = bytes ? malloc(size > 0 ? size : 1) : NULL;
    *count = array ? n : 0;
    taking->no_memory |= bytes && !array;
    if (array)
        memcpy(array, bytes, size);
    return array;
}

static void take_settings(struct source *source, struct cage *cage)
{
    uint32_t scheme = source_u32(source), boundary = source_u32(source);
    uint32_t chaikin = source_u32(source), smooth_triangles = source_u32(source);
    uint32_t up = source_u32(source);
    source->ok &= scheme <= CAGE_SCHEME_BILINEAR && boundary <= CAGE_BOUNDARY_NONE &&
                  chaikin <= 1 && smooth_triangles <= 1 && up <= CAGE_UP_Z;
    cage->scheme = (enum cage_scheme)scheme;
    cage->boundary = (enum cage_boundary)boundary;
    cage->chaikin = chaikin != 0;
    cage->smooth_triangles = smooth_triangles != 0;
    cage->up = (enum cage_up)up;
}

static void take_warnings(struct taking *taking, struct cage *cage)
{
    const char *warnings = source_text(taking->source);
    if (!warnings[0])
        return;
    cage->warnings = strndup(warnings, CAGE_WARNINGS_BYTES - 1);
    taking->no_memory |= !cage->warnings;
    for (char *c = cage->warnings; c && *c; c++)
        if (((unsigned char)*c < 0x20 && *c != '\n') || *c == 0x7f)
            *c = '?';
}

/* Reads the findings: at most one of each kind, each with a count above 0. */
static void take_findings(struct source *source, struct cage *cage)
{
    uint32_t n = source_u32(source), seen = 0;
    source->ok &= n <= N_CAGE_FINDINGS;
    for (uint32_t i = 0; source->ok && i < n; i++) {
        uint32_t kind = source_u32(source), count = source_u32(source);
        uint32_t line = source_u32(source), face = source_u32(source);
        source->ok &= kind < N_CAGE_FINDINGS && count > 0 && !(seen & 1u << (kind & 31u));
        if (!source->ok)
            return;
        seen |= 1u << kind;
        cage->finding[cage->n_findings++] =
            (struct cage_finding){(enum cage_finding_kind)kind, count, line, face};
    }
}

bool cage_take(struct source *source, struct cage *cage, const char *name, struct error *error)
{
    struct taking taking = {source, false};
    size_t n_face_vertices;
    *cage = (struct cage){0};
    take_settings(source, cage);
    take_warnings(&taking, cage);
    cage->position = take_array(&taking, &cage->n_vertices, 0, sizeof *cage->position);
    cage->face_start = take_array(&taking, &cage->n_faces, 1, sizeof *cage->face_start);
    cage->face_vertex = take_array(&taking, &n_face_vertices, 0, sizeof *cage->face_vertex);
    cage->crease = take_array(&taking, &cage->n_creases, 0, sizeof *cage->crease);
    cage->corner = take_array(&taking, &cage->n_corners, 0, sizeof *cage->corner);
    cage->hole = take_array(&taking, &cage->n_holes, 0, sizeof *cage->hole);
    cage->patch = take_array(&taking, &cage->n_patches, 0, sizeof *cage->patch);
    take_findings(source, cage);
    bool ok = false;
    if (taking.no_memory)
        error_set(error, ERROR_SERVER, "%s: no memory for the cage: try again later", name);
    else if (!source->ok || source->left > 0 || cage->face_start[cage->n_faces] != n_face_vertices)
        error_set(error, ERROR_MODEL, "%s: the process that read it handed back no cage", name);
    else
        ok = cage_check(cage, name, error);
    if (!ok)
        cage_finish(cage);
    return ok;
}
