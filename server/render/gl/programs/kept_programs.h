/* The programs on the device, and those that are ordered from the maker (maker.h). Frames hold the
 * programs that they wait for; of the others the most recently used are kept. A lock protects the
 * list, because the render thread, the maker's thread and threads that give up frames use it. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_KEPT_PROGRAMS_H
#define SHEEN_RENDER_GL_PROGRAMS_KEPT_PROGRAMS_H

#include <epoxy/gl.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/gl/programs/sources.h"
#include "server/scene/frame_request.h"

enum {
    /* The most programs that one frame needs: those that read tables or draw polygons, five for
     * each light, and one for its planes. */
    MAX_FRAME_PROGRAMS = TABLE_PROGRAMS + 5 * MAX_LIGHTS + 1,
    MAX_KEPT_PROGRAMS = 64,
    /* What a program takes of main memory at most, as measured on Mesa's software device without kept
     * shaders; 2 MB with them. */
    PROGRAM_BYTES = 7000000
};

struct kept_programs;

/* The programs that a frame needs and holds: none of them is removed, and those that are missing
 * are being made. All zero: holds nothing. */
struct program_hold {
    struct kept_programs *programs; /* NULL: holds nothing */
    int n;
    uint8_t at[MAX_FRAME_PROGRAMS]; /* places in the list */
};

/* The list counts its holders: the renderer, which calls kept_programs_release() once, and each
 * program_hold. The last one frees it. NULL when memory is short. `woken` is called, on any thread,
 * whenever a frame that waits should try again: a program is made, or places are free. May be
 * NULL. */
struct kept_programs *kept_programs_create(void (*woken)(void *owner), void *owner);
/* The renderer ends: woken() is not called any more. */
void kept_programs_release(struct kept_programs *programs); /* NULL is safe */

/* --- for frames */

enum hold_state {
    HOLD_READY,  /* all programs are made */
    HOLD_WAITS,  /* try again when woken() is called */
    HOLD_FAILED, /* *error has the driver's reason; nothing is held any more */
};
/* Holds the programs of a frame, at most MAX_FRAME_PROGRAMS, and orders those that are missing. If
 * the list has no room for all of them, because other frames hold theirs, holds nothing yet.
 * `asker` tells whose frame it is: the maker works for the askers in turns. GL thread. */
enum hold_state kept_programs_hold(struct kept_programs *programs, struct program_hold *hold,
                                   const struct program_id *ids, int n, uint64_t asker,
                                   struct error *error);
/* Waits on this thread until kept_programs_hold() may succeed. GL thread. */
void kept_programs_wait(struct kept_programs *programs);
/* Any thread, also after the renderer was destroyed. Programs that nobody else waits for are not
 * made. */
void program_hold_end(struct program_hold *hold);

/* The name of a program that is made; else 0. *has_run (may be NULL): kept_programs_note_run() was
 * called for it. GL thread. */
GLuint kept_programs_find(struct kept_programs *programs, const struct program_id *id,
                          bool *has_run);
/* The program has run in the render thread's context. GL thread. */
void kept_programs_note_run(struct kept_programs *programs, const struct program_id *id);

/* Orders a program that no frame needs yet; the maker makes it when no frame waits. It is not
 * ordered if there is no free place. GL thread. */
void kept_programs_order(struct kept_programs *programs, const struct program_id *id);
/* The context is lost: all names are invalid, and what frames hold is made again. No maker may be
 * working. GL thread. */
void kept_programs_forget(struct kept_programs *programs);
/* Removes programs that no frame holds, those used longest ago first, until at most so many are made.
 * GL thread. */
void kept_programs_drop(struct kept_programs *programs, unsigned most);
/* The number of programs that are made. Any thread. */
unsigned kept_programs_count(struct kept_programs *programs);

/* --- for the maker */

/* Waits for an order, and takes it. False when kept_programs_close() has been called. */
bool kept_programs_take_order(struct kept_programs *programs, struct program_id *id, int *at);
/* Ends the order. name: the program; 0: the driver failed, and *error tells why. */
void kept_programs_finish_order(struct kept_programs *programs, int at, GLuint name,
                                const struct error *error);
/* Ends the waiting of kept_programs_take_order(), until kept_programs_open(). GL thread. */
void kept_programs_close(struct kept_programs *programs);
void kept_programs_open(struct kept_programs *programs);

#endif
