#include "server/render/gl/maker/maker.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "server/render/gl/context/quirks.h"
#include "server/render/gl/programs/program.h"
#include "server/render/gl/maker/first_run.h"

struct maker {
    const struct egl *egl;
    EGLContext context; /* current on the maker's thread */
    struct kept_programs *programs;
    struct maker_watch watch;
    pthread_t thread;
    struct first_runs runs; /* objects of the thread */
};

/* Another thread of the driver stores the generated code. The render thread, which would otherwise
 * generate it again, sees the program after this time. */
static void let_driver_store(void)
{
    const struct timespec time = {.tv_nsec = SOFTWARE_STORE_NS};
    nanosleep(&time, NULL);
}

static GLuint make(struct maker *maker, const struct program_id *id, struct error *error)
{
    const struct program_source source = source_of_program(id);
    GLuint name = program_create(&source, error);
    if (!name)
        return 0;
    if (id->set == SET_SHADING)
        first_run(&maker->runs, &id->shading, name);
    glFinish(); /* other contexts may use it from here on */
    if (maker->egl->software)
        let_driver_store();
    return name;
}

static void tell(const struct maker *maker, bool begins)
{
    if (maker->watch.compiling)
        maker->watch.compiling(maker->watch.owner, begins);
}

static void *run(void *argument)
{
    struct maker *maker = argument;
    struct program_id id;
    int at;
    bool is_ready = egl_make_current(maker->egl, maker->context);
    struct error failure;
    if (!is_ready)
        error_set(&failure, ERROR_DEVICE, "the device's second context cannot be used");
    while (kept_programs_take_order(maker->programs, &id, &at)) {
        tell(maker, true);
        GLuint name = is_ready ? make(maker, &id, &failure) : 0;
        tell(maker, false);
        kept_programs_finish_order(maker->programs, at, name, &failure);
    }
    egl_make_current(maker->egl, EGL_NO_CONTEXT);
    return NULL;
}

struct maker *maker_create(struct egl *egl, struct kept_programs *programs,
                           struct maker_watch watch, struct error *error)
{
    struct maker *maker = calloc(1, sizeof *maker);
    if (!maker) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    maker->egl = egl;
    maker->programs = programs;
    maker->watch = watch;
    maker->context = egl_create_sharing(egl);
    if (maker->context == EGL_NO_CONTEXT) {
        error_set(error, ERROR_DEVICE, "the device gives no second context, for compiling");
        free(maker);
        return NULL;
    }
    kept_programs_open(programs);
    if (pthread_create(&maker->thread, NULL, run, maker) != 0) {
        error_set(error, ERROR_SERVER, "no thread for compiling");
        eglDestroyContext(egl->display, maker->context);
        free(maker);
        return NULL;
    }
    pthread_setname_np(maker->thread, "sheend-compile");
    return maker;
}

void maker_destroy(struct maker *maker)
{
    if (!maker)
        return;
    kept_programs_close(maker->programs);
    pthread_join(maker->thread, NULL);
    eglDestroyContext(maker->egl->display, maker->context);
    free(maker);
}
