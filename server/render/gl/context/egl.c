#include "server/render/gl/context/egl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/render/gl/context/libraries.h"

enum { MAX_DEVICES = 64 };

static bool has_word(const char *list, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = list; at && (at = strstr(at, word)); at += n)
        if ((at == list || at[-1] == ' ') && (at[n] == ' ' || !at[n]))
            return true;
    return false;
}

static bool is_software(EGLDeviceEXT device)
{
    return has_word(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

/* Attempts in order: robust access with notification of resets, notification alone, neither. */
enum { ROBUSTNESS_KINDS = 3 };

static EGLContext create_context(const struct egl *egl, int robustness, EGLContext share)
{
    /* All attempts share the last three pairs, so these come at the end. */
    static const EGLint attributes[] = {EGL_CONTEXT_OPENGL_ROBUST_ACCESS,
                                        EGL_TRUE,
                                        EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                        EGL_LOSE_CONTEXT_ON_RESET,
                                        EGL_CONTEXT_MAJOR_VERSION,
                                        4,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        5,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_NONE};
    /* The API is chosen for each thread. */
    if (!eglBindAPI(EGL_OPENGL_API))
        return EGL_NO_CONTEXT;
    return eglCreateContext(egl->display, EGL_NO_CONFIG_KHR, share, attributes + 2 * robustness);
}

bool egl_make_current(const struct egl *egl, EGLContext context)
{
    return eglBindAPI(EGL_OPENGL_API) &&
           eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

EGLContext egl_create_sharing(const struct egl *egl)
{
    return create_context(egl, egl->robustness, egl->context);
}

static bool open_context(struct egl *egl)
{
    for (int kind = 0; kind < ROBUSTNESS_KINDS && egl->context == EGL_NO_CONTEXT; kind++) {
        egl->context = create_context(egl, kind, EGL_NO_CONTEXT);
        egl->robustness = kind;
    }
    return egl->context != EGL_NO_CONTEXT && egl_make_current(egl, egl->context);
}

static bool open_device(struct egl *egl, EGLDeviceEXT device)
{
    egl->context = EGL_NO_CONTEXT;
    egl->device = device;
    egl->software = is_software(device);
    egl->display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, NULL);
    if (egl->display == EGL_NO_DISPLAY || !eglInitialize(egl->display, NULL, NULL))
        return false;
    if (open_context(egl))
        return true;
    egl_finish(egl);
    return false;
}

/* Writes the devices to try, in order of preference. Returns their number. */
static int choose_devices(const char *wanted, const EGLDeviceEXT *all, int n, EGLDeviceEXT *chosen,
                          struct error *error)
{
    int n_chosen = 0;
    char *end;
    long index = strtol(wanted, &end, 10);
    if (end != wanted && !*end) {
        if (index >= 0 && index < n)
            chosen[n_chosen++] = all[index];
        else
            error_set(error, ERROR_DEVICE, "there is no EGL device %s: %d found, numbered from 0",
                      wanted, n);
        return n_chosen;
    }
    bool any = strcmp(wanted, "auto") == 0, hardware = strcmp(wanted, "hardware") == 0;
    if (!any && !hardware && strcmp(wanted, "software") != 0) {
        error_set(error, ERROR_REQUEST, "device '%s' is not auto, hardware, software or a number",
                  wanted);
        return 0;
    }
    for (int software = !any && !hardware; software < 2 - hardware; software++)
        for (int i = 0; i < n; i++)
            if (is_software(all[i]) == (software == 1))
                chosen[n_chosen++] = all[i];
    if (!n_chosen)
        error_set(error, ERROR_DEVICE, "no %s EGL device among %d found: install %s", wanted, n,
                  hardware ? "a GPU's driver with EGL" : "libgl1-mesa-dri");
    return n_chosen;
}

bool egl_init(struct egl *egl, const char *device, struct error *error)
{
    *egl = (struct egl){.display = EGL_NO_DISPLAY, .context = EGL_NO_CONTEXT};
    EGLDeviceEXT all[MAX_DEVICES], chosen[MAX_DEVICES];
    EGLint n = 0;
    if (!libraries_load(error))
        return false;
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))
        return error_set(error, ERROR_DEVICE,
                         "EGL cannot list devices here (EGL_EXT_device_enumeration is missing): "
                         "install libegl1 and libgl1-mesa-dri, or a GPU driver with EGL");
    if (!eglQueryDevicesEXT(MAX_DEVICES, all, &n) || n < 1)
        return error_set(error, ERROR_DEVICE,
                         "no EGL device found: install libgl1-mesa-dri or a GPU driver with EGL");
    int n_chosen = choose_devices(device, all, n, chosen, error);
    if (!n_chosen)
        return false;
    for (int i = 0; i < n_chosen; i++)
        if (open_device(egl, chosen[i]))
            return true;
    return error_set(error, ERROR_DEVICE,
                     "none of %d EGL devices tried gives an OpenGL 4.5 core context (--device %s)",
                     n_chosen, device);
}

bool egl_reopen(struct egl *egl)
{
    egl_finish(egl);
    return open_device(egl, egl->device);
}

void egl_finish(struct egl *egl)
{
    if (egl->display == EGL_NO_DISPLAY)
        return;
    eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (egl->context != EGL_NO_CONTEXT)
        eglDestroyContext(egl->display, egl->context);
    eglTerminate(egl->display);
    *egl =
        (struct egl){.display = EGL_NO_DISPLAY, .context = EGL_NO_CONTEXT, .device = egl->device};
}
