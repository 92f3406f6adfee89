#include "server/render/gl/context/libraries.h"

#include <dlfcn.h>
#include <stddef.h>

/* In the order in which libepoxy opens them: EGL at the first egl call; at the first gl call libGL
 * or, where it is missing, libOpenGL. */
static const struct {
    const char *name, *other; /* either will do; NULL: there is no other */
    const char *package;      /* Debian's, without X11 */
} LIBRARIES[] = {
    {"libEGL.so.1", NULL, "libegl1"},
    {"libOpenGL.so.0", "libGL.so.1", "libopengl0"},
};

static bool load(const char *name)
{
    return name && dlopen(name, RTLD_LAZY | RTLD_LOCAL);
}

bool libraries_load(struct error *error)
{
    for (size_t i = 0; i < sizeof LIBRARIES / sizeof *LIBRARIES; i++) {
        const char *name = LIBRARIES[i].name, *other = LIBRARIES[i].other;
        if (load(other) || load(name))
            continue;
        const char *why = dlerror();
        return error_set(error, ERROR_DEVICE,
                         "%s%s%s cannot be loaded on this machine: install %s (Debian); the loader "
                         "says: %s",
                         name, other ? " or " : "", other ? other : "", LIBRARIES[i].package,
                         why ? why : "nothing");
    }
    return true;
}
