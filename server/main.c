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

/* A whole number from low to high; a suffix K, M, G or T multiplies by powers of 1024. */
static bool parse_number(const char *value, uint64_t low, uint64_t high, bool suffixes,
                         uint64_t *number)
{
    if (*value < '0' || *value > '9')
        return false;
    char *end;
    errno = 0;
    uint64_t n = strtoull(value, &end, 10);
    const char *suffix = suffixes && *end ? strchr("KMGT", *end) : NULL;
    if (suffix) {
        end++;
        for (long i = suffix - "KMGT"; errno == 0 && i >= 0; i--)
            errno = __builtin_mul_overflow(n, 1024, &n) ? ERANGE : 0;
    }
    *number = n;
    return errno == 0 && *end == 0 && n >= low && n <= high;
}

static bool set_number(const char *name, const char *value, uint64_t low, uint64_t high,
                       uint64_t *number, struct error *error)
{
    return parse_number(value, low, high, false, number) ||
           error_set(error, ERROR_REQUEST,
                     "%s is '%s'; it must be a whole number from %llu to %llu", name, value,
                     (unsigned long long)low, (unsigned long long)high);
}

static bool set_device(struct settings *settings, const char *value, struct error *error)
{
    uint64_t number;
    if (strcmp(value, "auto") != 0 && strcmp(value, "software") != 0 &&
        !parse_number(value, 0, 1023, false, &number))
        return error_set(error, ERROR_REQUEST,
                         "device is '%s'; it must be auto, software or a device's number", value);
    snprintf(settings->device, sizeof settings->device, "%s", value);
    return true;
}

static bool set_memory_budget(struct settings *settings, const char *value, struct error *error)
{
    uint64_t bytes;
    if (!parse_number(value, 1, SIZE_MAX / 2, true, &bytes))
        return error_set(error, ERROR_REQUEST,
                         "memory-budget is '%s'; it must be bytes, as 4000000000, 800M or 4G",
                         value);
    settings->service.memory_budget_bytes = bytes;
    return true;
}

static bool set_threads(struct settings *settings, const char *value, struct error *error)
{
    uint64_t n = 0;
    bool ok = set_number("threads", value, 1, POOL_MAX_THREADS, &n, error);
    settings->service.n_threads = (unsigned)n;
    return ok;
}

static bool set_idle_timeout(struct settings *settings, const char *value, struct error *error)
{
    uint64_t n = 0;
    bool ok = set_number("idle-timeout", value, 0, 10000000, &n, error);
    settings->service.idle_timeout_s = (unsigned)n;
    return ok;
}

static bool set_drain_timeout(struct settings *settings, const char *value, struct error *error)
{
    uint64_t n = 0;
    bool ok = set_number("drain-timeout", value, 0, 10000000, &n, error);
    settings->service.drain_timeout_s = (unsigned)n;
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

/* --- the table of options: getopt, --help and the configuration file all read it */

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
    {"memory-budget", "BYTES", "most that models and images may take; K, M, G (default: 4G)",
     set_memory_budget, true},
    {"threads", "N", "for building tables and encoding (default: one per processor)", set_threads,
     true},
    {"idle-timeout", "SECONDS", "disconnect a client without a request; 0: never (default: 900)",
     set_idle_timeout, true},
    {"drain-timeout", "SECONDS",
     "after SIGTERM, how long a client may take to read its frames (default: 30)",
     set_drain_timeout, true},
    {"config", "FILE", "lines 'name = value' with the names above; options given here go first",
     set_config, false},
    {"check-config", NULL, "check the options and the file, then exit", set_check_config, false},
    {"session-fd", "N", "serve this connected socket alone and end with it", set_session_fd, false},
    {"version", NULL, "print the version and exit", NULL, false},
    {"help", NULL, "print this and exit", NULL, false},
};
#define N_OPTIONS (sizeof OPTIONS / sizeof *OPTIONS)

static void print_help(void)
{
    puts(
        "sheend renders exact reflection lines on subdivision surfaces for clients of its socket.\n"
        "\nusage: sheend [options]\n");
    for (size_t i = 0; i < N_OPTIONS; i++) {
        char name[64];
        snprintf(name, sizeof name, "--%s %s", OPTIONS[i].name,
                 OPTIONS[i].argument ? OPTIONS[i].argument : "");
        printf("  %-26s", name);
        for (const char *c = OPTIONS[i].help; *c; c++)
            *c == '\n' ? (void)printf("\n  %-26s", "") : (void)putchar(*c);
        putchar('\n');
    }
    puts("\nexamples:\n"
         "  sheend                                       a daemon for this user alone\n"
         "  sheend --listen unix:/run/sheen/sheen.sock   at a place of your choice\n"
         "  sheend --listen tcp:127.0.0.1:7410 --device software --memory-budget 2G\n"
         "  sheend --config /etc/sheen/sheend.conf --check-config\n"
         "\nSIGTERM and SIGINT finish what is in flight; a second one ends at once.\n"
         "exit codes: 0 done, 2 wrong usage, 4 cannot serve, 5 no device");
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

/* Walks the command line: --config alone, or all the others, so that they override the file. */
static bool walk_options(int argc, char **argv, struct settings *settings, bool config_only,
                         bool *has_listen, struct error *error)
{
    struct option long_options[N_OPTIONS + 1] = {{0}};
    for (size_t i = 0; i < N_OPTIONS; i++)
        long_options[i] = (struct option){
            OPTIONS[i].name, OPTIONS[i].argument ? required_argument : no_argument, NULL, 0};
    optind = 1;
    opterr = 0;
    for (int c, index; (c = getopt_long(argc, argv, "", long_options, &index)) != -1;) {
        if (c != 0)
            return error_set(error, ERROR_REQUEST,
                             "'%s' is no option or lacks its value; sheend --help lists them",
                             argv[optind - 1]);
        const struct option_row *row = &OPTIONS[index];
        if (!row->set) {
            strcmp(row->name, "help") == 0 ? print_help() : (void)puts("sheend " SHEEN_VERSION);
            exit(EXIT_DONE);
        }
        *has_listen |= row->set == set_listen;
        if ((row->set == set_config) == config_only && !row->set(settings, optarg, error))
            return false;
    }
    return optind == argc || error_set(error, ERROR_REQUEST,
                                       "'%s' is no option; sheend --help "
                                       "lists them",
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
    if (!walk_options(argc, argv, settings, true, &has_listen, error) ||
        (settings->config && !read_config(settings, has_listen, error)) ||
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
        .service = {.session_fd = -1,
                    .memory_budget_bytes = (size_t)4 << 30,
                    .n_threads = count_processors(),
                    .idle_timeout_s = 900,
                    .drain_timeout_s = 30},
    };
    struct service_options *options = &settings.service;
    if (!read_settings(argc, argv, &settings, &error))
        return fail(&error);
    if (settings.check_config) {
        puts("the configuration is good");
        return EXIT_DONE;
    }
    bool single = options->session_fd >= 0;
    if (single)
        options->n_listen = options->idle_timeout_s = 0;
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
