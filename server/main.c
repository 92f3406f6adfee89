/* sheend: options, configuration, start-up and shutdown. */
#include <errno.h>
#include <getopt.h>
#include <ini.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/service/listen.h"
#include "server/service/pool.h"
#include "server/service/service.h"

enum exit_code { EXIT_DONE = 0, EXIT_USAGE = 2, EXIT_SERVICE = 4, EXIT_DEVICE = 5 };

struct settings {
    struct service_options service;
    char device[64];
    const char *config; /* path, or NULL */
    bool check_config;
    void (*show)(void); /* and no more; NULL: go on */
};

/* --- the values of options */

static bool set_listen(struct settings *settings, const char *value, struct error *error)
{
    char text[ADDRESS_TEXT_BYTES];
    struct service_options *service = &settings->service;
    if (service->n_listen == SERVICE_MAX_LISTENERS)
        return error_set(error, ERROR_REQUEST, "at most %d addresses to listen on",
                         SERVICE_MAX_LISTENERS);
    if (!address_parse(&service->listen[service->n_listen], value, text))
        return error_set(error, ERROR_REQUEST, "%s", text);
    service->n_listen++;
    return true;
}

static bool set_number(const char *name, const char *value, uint64_t low, uint64_t high,
                       uint64_t *number, struct error *error)
{
    return number_parse(value, low, high, false, number) ||
           error_set(error, ERROR_REQUEST,
                     "%s is '%s'; it must be a whole number from %llu to %llu", name, value,
                     (unsigned long long)low, (unsigned long long)high);
}

static bool set_device(struct settings *settings, const char *value, struct error *error)
{
    uint64_t number;
    if (strcmp(value, "auto") != 0 && strcmp(value, "software") != 0 &&
        !number_parse(value, 0, 1023, false, &number))
        return error_set(error, ERROR_REQUEST,
                         "device is '%s'; it must be auto, software or a device's number", value);
    snprintf(settings->device, sizeof settings->device, "%s", value);
    return true;
}

static bool set_threads(struct settings *settings, const char *value, struct error *error)
{
    uint64_t n = 0;
    bool ok = set_number("threads", value, 1, POOL_MAX_THREADS, &n, error);
    settings->service.n_threads = (unsigned)n;
    return ok;
}

static bool set_session_fd(struct settings *settings, const char *value, struct error *error)
{
    uint64_t fd = 0;
    struct stat file;
    if (!set_number("session-fd", value, 0, 1000000, &fd, error))
        return false;
    if (fstat((int)fd, &file) < 0 || !S_ISSOCK(file.st_mode))
        return error_set(error, ERROR_REQUEST, "session-fd %s is no open socket", value);
    settings->service.session_fd = (int)fd;
    return true;
}

static bool set_config(struct settings *settings, const char *value, struct error *error)
{
    (void)error;
    settings->config = value;
    return true;
}

static bool set_check_config(struct settings *settings, const char *value, struct error *error)
{
    (void)value;
    (void)error;
    settings->check_config = true;
    return true;
}

/* --- the table of options: getopt, --help and the configuration file all read it, and then the
 * table of limits (limits.h) */

struct option_row {
    const char *name, *argument; /* argument: NULL when it takes none */
    const char *help;
    bool (*set)(struct settings *settings, const char *value, struct error *error);
    bool in_config;
};

static const struct option_row OPTIONS[] = {
    {"listen", "ADDRESS",
     "unix:PATH or tcp:HOST:PORT (loopback only); may be given several times\n"
     "(default: unix:$XDG_RUNTIME_DIR/sheen.sock, else unix:/tmp/sheen-UID/sheen.sock)",
     set_listen, true},
    {"device", "auto|software|N", "a GPU if there is one, the software device, or the N-th device",
     set_device, true},
    {"threads", "N", "for building tables and encoding (default: one per processor)", set_threads,
     true},
    {"config", "FILE", "lines 'name = value' with the names above; options given here go first",
     set_config, false},
    {"check-config", NULL, "check the options and the file, then exit", set_check_config, false},
    {"session-fd", "N", "serve this connected socket alone and end with it", set_session_fd, false},
    {"version", NULL, "print the version and exit", NULL, false},
    {"help", NULL, "print this and exit", NULL, false},
};
#define N_OPTIONS (sizeof OPTIONS / sizeof *OPTIONS)

/* `help` goes on in a column of its own. */
static void print_row(const char *name, const char *argument, const char *help)
{
    char option[64];
    snprintf(option, sizeof option, "--%s %s", name, argument ? argument : "");
    printf("  %-30s", option);
    for (const char *c = help; *c; c++)
        *c == '\n' ? (void)printf("\n  %-30s", "") : (void)putchar(*c);
}

static void print_limits(void)
{
    puts("\nlimits; bytes take K, M, G:");
    for (size_t i = 0; i < N_LIMITS; i++) {
        char fallback[LIMITS_TEXT_BYTES];
        limits_format(&LIMITS[i], LIMITS[i].fallback, fallback);
        print_row(LIMITS[i].name, limits_argument(&LIMITS[i]), LIMITS[i].help);
        printf(" (default: %s)\n", fallback);
    }
}

static void print_help(void)
{
    puts(
        "sheend renders exact reflection lines on subdivision surfaces for clients of its socket.\n"
        "\nusage: sheend [options]\n");
    for (size_t i = 0; i < N_OPTIONS; i++) {
        print_row(OPTIONS[i].name, OPTIONS[i].argument, OPTIONS[i].help);
        putchar('\n');
    }
    print_limits();
    puts("\nexamples:\n"
         "  sheend                                       a daemon for this user alone\n"
         "  sheend --listen unix:/run/sheen/sheen.sock   at a place of your choice\n"
         "  sheend --listen tcp:127.0.0.1:7410 --device software --memory-budget 2G\n"
         "  sheend --config /etc/sheen/sheend.conf --check-config\n"
         "\nSIGTERM and SIGINT finish what is in flight; a second one ends at once.\n"
         "exit codes: 0 done, 2 wrong usage, 4 cannot serve, 5 no device");
}

static void print_version(void)
{
    puts("sheend " SHEEN_VERSION);
}

/* --- reading them */

struct config_reader {
    struct settings *settings;
    bool skip_listen; /* the command line says where */
    struct error *error;
};

/* inih's handler: 0 is an error. Only the first counts. */
static int config_value(void *user, const char *section, const char *name, const char *value)
{
    struct config_reader *reader = user;
    if (reader->error->kind != ERROR_NONE)
        return 0;
    if (*section && strcmp(section, "sheend") != 0)
        return error_set(reader->error, ERROR_REQUEST, "unknown section [%s]; use [sheend]",
                         section);
    for (size_t i = 0; i < N_OPTIONS; i++) {
        if (!OPTIONS[i].in_config || strcmp(name, OPTIONS[i].name) != 0)
            continue;
        if (OPTIONS[i].set == set_listen && reader->skip_listen)
            return 1;
        return OPTIONS[i].set(reader->settings, value, reader->error);
    }
    for (size_t i = 0; i < N_LIMITS; i++)
        if (strcmp(name, LIMITS[i].name) == 0)
            return limits_set(&reader->settings->service.limits, &LIMITS[i], value, reader->error);
    return error_set(reader->error, ERROR_REQUEST, "unknown name '%s'; sheend --help lists them",
                     name);
}

static bool read_config(struct settings *settings, bool skip_listen, struct error *error)
{
    struct error found = {0};
    struct config_reader reader = {settings, skip_listen, &found};
    int line = ini_parse(settings->config, config_value, &reader);
    if (line == 0)
        return true;
    if (line < 0)
        return error_set(error, ERROR_REQUEST, "cannot read %s: %s", settings->config,
                         strerror(errno));
    return error_set(error, ERROR_REQUEST, "%s:%d: %s", settings->config, line,
                     found.kind != ERROR_NONE ? found.text : "a line must be 'name = value'");
}

/* getopt's table: OPTIONS, then LIMITS. NULL without memory. */
static struct option *long_options(void)
{
    struct option *options = calloc(N_OPTIONS + N_LIMITS + 1, sizeof *options);
    for (size_t i = 0; options && i < N_OPTIONS; i++)
        options[i] = (struct option){
            OPTIONS[i].name, OPTIONS[i].argument ? required_argument : no_argument, NULL, 0};
    for (size_t i = 0; options && i < N_LIMITS; i++)
        options[N_OPTIONS + i] = (struct option){LIMITS[i].name, required_argument, NULL, 0};
    return options;
}

/* One option in its turn: --config alone, or all the others. */
static bool take_option(struct settings *settings, size_t index, bool config_only, bool *has_listen,
                        struct error *error)
{
    if (index >= N_OPTIONS)
        return config_only ||
               limits_set(&settings->service.limits, &LIMITS[index - N_OPTIONS], optarg, error);
    const struct option_row *row = &OPTIONS[index];
    if (!row->set) {
        settings->show = strcmp(row->name, "help") == 0 ? print_help : print_version;
        return true;
    }
    *has_listen |= row->set == set_listen;
    return (row->set == set_config) != config_only || row->set(settings, optarg, error);
}

/* Walks the command line: --config alone, or all the others, so that they override the file. */
static bool walk_options(int argc, char **argv, struct settings *settings, bool config_only,
                         bool *has_listen, struct error *error)
{
    struct option *options = long_options();
    if (!options)
        return error_set(error, ERROR_SERVER, "no memory for the options");
    bool ok = true;
    optind = 1;
    opterr = 0;
    for (int c, index;
         ok && !settings->show && (c = getopt_long(argc, argv, "", options, &index)) != -1;)
        ok = c == 0 ? take_option(settings, (size_t)index, config_only, has_listen, error)
                    : error_set(error, ERROR_REQUEST,
                                "'%s' is no option or lacks its value; sheend --help lists them",
                                argv[optind - 1]);
    free(options);
    if (!ok || settings->show || optind == argc)
        return ok;
    return error_set(error, ERROR_REQUEST, "'%s' is no option; sheend --help lists them",
                     argv[optind]);
}

/* --- defaults */

static unsigned count_processors(void)
{
    cpu_set_t set;
    int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return n < 1 ? 1 : n > (int)POOL_MAX_THREADS ? POOL_MAX_THREADS : (unsigned)n;
}

/* Without a directory that the system made for this user, one of his own under /tmp, where anybody
 * might have put something of that name. */
static bool set_default_listen(struct settings *settings, struct error *error)
{
    char path[512], address[sizeof path + 32];
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    if (runtime && runtime[0] == '/') {
        snprintf(path, sizeof path, "%s", runtime);
    } else {
        struct stat file;
        snprintf(path, sizeof path, "/tmp/sheen-%lu", (unsigned long)getuid());
        if (mkdir(path, 0700) < 0 && errno != EEXIST)
            return error_set(error, ERROR_SERVER, "cannot make %s: %s", path, strerror(errno));
        if (lstat(path, &file) < 0 || !S_ISDIR(file.st_mode) || file.st_uid != getuid() ||
            (file.st_mode & 077) != 0)
            return error_set(error, ERROR_SERVER,
                             "%s is not a directory of yours alone: remove it, or use --listen",
                             path);
    }
    snprintf(address, sizeof address, "unix:%s/sheen.sock", path);
    return set_listen(settings, address, error);
}

static bool read_settings(int argc, char **argv, struct settings *settings, struct error *error)
{
    bool has_listen = false;
    if (!walk_options(argc, argv, settings, true, &has_listen, error))
        return false;
    if (settings->show)
        return true;
    if ((settings->config && !read_config(settings, has_listen, error)) ||
        !walk_options(argc, argv, settings, false, &has_listen, error))
        return false;
    struct service_options *service = &settings->service;
    if (service->session_fd >= 0 && has_listen)
        return error_set(error, ERROR_REQUEST, "--session-fd and --listen exclude each other");
    for (size_t i = 0; i < service->n_listen; i++)
        if (!listener_check(&service->listen[i], error))
            return false;
    return true;
}

static int fail(const struct error *error)
{
    fprintf(stderr, "sheend: %s\n", error->text);
    return error->kind == ERROR_REQUEST  ? EXIT_USAGE
           : error->kind == ERROR_DEVICE ? EXIT_DEVICE
                                         : EXIT_SERVICE;
}

int main(int argc, char **argv)
{
    struct error error = {0};
    struct settings settings = {
        .device = "auto",
        .service = {.session_fd = -1, .n_threads = count_processors()},
    };
    struct service_options *options = &settings.service;
    limits_init(&options->limits);
    if (!read_settings(argc, argv, &settings, &error))
        return fail(&error);
    if (settings.show) {
        settings.show();
        return EXIT_DONE;
    }
    if (settings.check_config) {
        puts("the configuration is good");
        return EXIT_DONE;
    }
    bool single = options->session_fd >= 0;
    if (single)
        options->n_listen = options->limits.idle_s = 0;
    else if (options->n_listen == 0 && !set_default_listen(&settings, &error))
        return fail(&error);
    options->device = settings.device;

    struct service *service = service_create(options, &error);
    if (!service)
        return fail(&error);
    char addresses[SERVICE_MAX_LISTENERS * LISTENER_TEXT_BYTES];
    service_addresses(service, addresses, sizeof addresses);
    if (!single)
        fprintf(stderr, "sheend %s on %s, listening on %s\n", SHEEN_VERSION,
                service_device(service)->device, addresses);
    service_run(service);
    service_destroy(service);
    return EXIT_DONE;
}
