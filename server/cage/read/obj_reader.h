/* What the parts of the OBJ reader, obj.c and obj_*.c, share. Internal to them. */
#ifndef SHEEN_CAGE_READ_OBJ_READER_H
#define SHEEN_CAGE_READ_OBJ_READER_H

#include <locale.h>

#include "server/cage/build/builder.h"
#include "server/cage/build/piece_basis.h"
#include "server/cage/read/obj_text.h"

/* Numbers of one kind that have been read so far. */
struct obj_numbers {
    double *value;
    size_t n, room;
};

/* A free-form surface (obj_surface.c), and the settings for those that follow. */
struct obj_surface {
    struct obj_field type; /* of cstype; length 0: none was given */
    bool is_rational;
    uint32_t type_line;
    double degree[2];             /* of deg; 0: none was given */
    double step[2];               /* of step; 0: none was given */
    struct obj_numbers matrix[2]; /* of bmat */
    uint32_t line;                /* of its surf; 0: outside of surfaces */
    double range[4];              /* u from and to, v from and to */
    uint32_t *point;
    size_t n_points, point_room;
    struct obj_numbers knots[2];
};

struct obj_reader {
    struct obj_text text;
    struct cage_builder *builder;
    const char *name;
    locale_t c_locale;
    uint32_t line; /* where the current statement starts */
    bool warned_keyword, warned_facevarying, warned_negative;
    struct obj_surface surface;
    struct obj_numbers weight; /* of the first vertices; those beyond its end have the weight 1 */
    struct error *error;
};

/* The arguments of "%.*s" to show a field in a message, cut to 40 bytes. */
#define OBJ_SHOWN(field) (int)((field)->length < 40 ? (field)->length : 40), (field)->text

/* Sets ERROR_MODEL with the text "name:line: ..." and returns false. */
bool obj_fail(const struct obj_reader *reader, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Parses v, v/t, v//n or v/t/n. Texture and normal indices must be numbers, but are not used. */
bool obj_scan_corner(const struct obj_field *field, int64_t *vertex);

/* Reads a number; `what` has it if it is not one. False with ERROR_MODEL. */
bool obj_read_number(struct obj_reader *reader, const struct obj_field *field, const char *what,
                     double *number);
/* Appends the rest of the line to *numbers. False with ERROR_MODEL or ERROR_SERVER. */
bool obj_read_numbers(struct obj_reader *reader, const char *what, struct obj_numbers *numbers);
/* Appends a number. False with ERROR_SERVER. */
bool obj_add_number(struct obj_reader *reader, struct obj_numbers *numbers, double number);

/* Reads the rest of a line with a keyword of free-form surfaces (Wavefront's OBJ 3.0: cstype, deg,
 * bmat, step, surf, parm, trim, hole, end), and sets *is_known to whether it is one. False with
 * ERROR_MODEL, which names what sheen does not draw. */
bool obj_read_surface(struct obj_reader *reader, const struct obj_field *keyword, bool *is_known);

/* Read the rest of a line with bmat or step. False with ERROR_MODEL or ERROR_SERVER. */
bool obj_read_matrix(struct obj_reader *reader);
bool obj_read_step(struct obj_reader *reader);
/* True for the types whose pieces are polynomials in a basis of their own: cardinal, taylor and
 * bmatrix. */
bool obj_has_piece_basis(const struct obj_surface *surface);
/* Gets this basis along an axis, 0 or 1, from deg, bmat, step and parm. False with ERROR_MODEL. */
bool obj_piece_basis(const struct obj_reader *reader, int axis, struct piece_basis *basis);

/* Reads the weight of the vertex that comes next, if it has one: a fourth number, where no fifth
 * follows. Without it the weight is 1; text that is no finite number is kept as NaN. False with
 * ERROR_SERVER. */
bool obj_read_weight(struct obj_reader *reader);
/* The weight of a vertex before the current line. */
double obj_weight_of(const struct obj_reader *reader, uint32_t vertex);
/* At the end of the file: false with ERROR_MODEL if a surface has no end, or if there are faces,
 * too. */
bool obj_end_surfaces(struct obj_reader *reader);
/* Frees what surfaces and weights took. */
void obj_surface_finish(struct obj_reader *reader);

/* Reads the rest of a line that begins with "t": an OpenSubdiv tag. Any blanks and any length are
 * accepted. A crease may have one sharpness for all edges, one for each edge, or, as OpenSubdiv
 * counts them, one for each vertex. Stops before the end of the line. */
bool obj_read_tag(struct obj_reader *reader);

#endif
