/* Makes programs on a thread of its own, in a context that shares its names with the render
 * thread's. So the render thread draws frames whose programs exist while those of other frames are
 * compiled. GL thread. */
#ifndef SHEEN_RENDER_GL_MAKER_MAKER_H
#define SHEEN_RENDER_GL_MAKER_MAKER_H

#include "server/base/error.h"
#include "server/render/gl/context/egl.h"
#include "server/render/gl/programs/kept_programs.h"

struct maker;

/* Told on the maker's thread when it begins to make a program, and when it has ended. NULL: nobody is told. */
struct maker_watch {
    void (*compiling)(void *owner, bool begins);
    void *owner;
};

/* Starts the thread, which makes what is ordered in `programs`. *egl has the render thread's
 * context, which is current. Both must stay valid until maker_destroy(). NULL with ERROR_DEVICE if
 * the device gives no second context, or with ERROR_SERVER. */
struct maker *maker_create(struct egl *egl, struct kept_programs *programs,
                           struct maker_watch watch, struct error *error);
/* Waits for the program that is being made, and ends the thread. Orders stay in the list. NULL is
 * safe. */
void maker_destroy(struct maker *maker);

#endif
