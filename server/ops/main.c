/* sheend: start-up and shutdown. */
#include <malloc.h>
#include <stdio.h>

#include "server/ops/options.h"

enum exit_code { EXIT_DONE = 0, EXIT_USAGE = 2, EXIT_SERVICE = 4, EXIT_DEVICE = 5 };

/* What a reload needs: the command line, and the settings in force. */
struct program {
    int argc;
    char **argv;
    struct settings settings;
};

static bool reload(void *owner, struct service_options *options, struct error *error)
{
    struct program *program = owner;
    struct settings fresh;
    char kept[OPTIONS_CHANGED_BYTES];
    if (options_read(program->argc, program->argv, &fresh, error) != OPTIONS_SERVE)
        return false;
    options_reload(&program->settings, &fresh, kept);
    if (*kept)
        log_event(LOG_WARN, "options that wait for the next start", log_text("options", kept));
    *options = program->settings.service;
    return true;
}

static int fail(const struct error *error)
{
    fprintf(stderr, "sheend: %s\n", error->text);
    return error->kind == ERROR_REQUEST  ? EXIT_USAGE
           : error->kind == ERROR_DEVICE ? EXIT_DEVICE
                                         : EXIT_SERVICE;
}

/* The end after help, version or the answer of --check-config: a failure if standard output cannot
 * be written. */
static int end_output(void)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return EXIT_DONE;
    fputs("sheend: standard output cannot be written\n", stderr);
    return EXIT_SERVICE;
}

/* Memory that is freed goes back to the system, so that the resident size stays near what the memory budget
 * counts. By itself the allocator raises these thresholds to the largest block that was ever freed, and keeps a
 * heap for each thread. */
static void return_free_memory(void)
{
    mallopt(M_MMAP_THRESHOLD, 256 << 10);
    mallopt(M_TRIM_THRESHOLD, 1 << 20);
    mallopt(M_ARENA_MAX, 2);
}

int main(int argc, char **argv)
{
    struct error error = {0};
    struct program program = {.argc = argc, .argv = argv};
    const struct service_reloader reloader = {reload, &program};
    switch (options_read(argc, argv, &program.settings, &error)) {
    case OPTIONS_SERVE:
        break;
    case OPTIONS_CHECK:
        puts("the configuration is good");
        return end_output();
    case OPTIONS_DONE:
        return end_output();
    case OPTIONS_WRONG:
        return fail(&error);
    }
    return_free_memory();
    struct service *service = service_create(&program.settings.service, &reloader, &error);
    if (!service)
        return fail(&error);
    enum service_end end = service_run(service);
    service_destroy(service);
    return end;
}
