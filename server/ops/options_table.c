/* The table of options, and how their values are read. */
#include "server/ops/options_table.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "protocol/limits.h"
#include "protocol/number.h"
#include "server/base/processors.h"
#include "server/ops/device_choice.h"
#include "server/threads/render_thread.h"
#include "server/threads/pool.h"
#include "server/net/tokens.h"

/* --- values with a form of their own */

static bool add_listen(void *value, const char *text, struct error *error)
{
    struct service_listen *listen = value;
    char why[ADDRESS_TEXT_BYTES];
    if (listen->n == SERVICE_MAX_LISTENERS)
        return error_set(error, ERROR_REQUEST, "at most %d addresses to listen on",
                         SERVICE_MAX_LISTENERS);
    if (!address_parse(&listen->address[listen->n], text, why))
        return error_set(error, ERROR_REQUEST, "%s", why);
    listen->n++;
    return true;
}

static bool set_metrics(void *value, const char *text, struct error *error)
{
    /* only one address is kept: the last one given */
    memset(value, 0, sizeof(struct service_listen));
    return add_listen(value, text, error);
}

static bool set_choice(void *value, const char *text, const char *name, const char *const *choices,
                       struct error *error)
{
    char list[96] = "";
    for (int i = 0; choices[i]; i++) {
        if (strcmp(text, choices[i]) == 0) {
            memcpy(value, &i, sizeof i);
            return true;
        }
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", choices[i]);
    }
    return error_set(error, ERROR_REQUEST, "%s is '%s'; it must be one of %s", name, text, list);
}

static bool set_log_level(void *value, const char *text, struct error *error)
{
    _Static_assert(sizeof(enum log_level) == sizeof(int), "a choice is an int");
    static const char *const LEVELS[] = {[LOG_ERROR] = "error",
                                         [LOG_WARN] = "warn",
                                         [LOG_INFO] = "info",
                                         [LOG_DEBUG] = "debug",
                                         NULL};
    return set_choice(value, text, "log-level", LEVELS, error);
}

static bool set_log_format(void *value, const char *text, struct error *error)
{
    _Static_assert(sizeof(enum log_format) == sizeof(int), "a choice is an int");
    static const char *const FORMATS[] = {[LOG_LOGFMT] = "logfmt", [LOG_JSON] = "json", NULL};
    return set_choice(value, text, "log-format", FORMATS, error);
}

static bool add_id(void *value, const char *text, struct error *error)
{
    struct access_ids *ids = value;
    uint64_t id;
    if (!number_parse(text, 0, UINT32_MAX - 1, false, &id))
        return error_set(error, ERROR_REQUEST, "'%s' is no number of a user or group", text);
    if (ids->n == ACCESS_MAX_IDS)
        return error_set(error, ERROR_REQUEST, "at most %d users and %d groups may be listed",
                         ACCESS_MAX_IDS, ACCESS_MAX_IDS);
    ids->id[ids->n++] = id;
    return true;
}

static bool add_proxy_from(void *value, const char *text, struct error *error)
{
    return proxy_networks_add(value, text, error);
}

static bool hash_token(void *value, const char *text, struct error *error)
{
    (void)value;
    return tokens_print_line(text, error);
}

static bool set_device(void *value, const char *text, struct error *error)
{
    struct device_try tries[DEVICE_MOST_TRIES];
    if (!device_tries(text, tries))
        return error_set(error, ERROR_REQUEST,
                         "device is '%s'; it must be auto, software, native or a device's number",
                         text);
    snprintf(value, SERVICE_DEVICE_BYTES, "%s", text);
    return true;
}

/* "auto": one thread for each processor that this process may use. */
static bool read_threads(void *value, const char *text, const char *name, unsigned most,
                         struct error *error)
{
    uint64_t n;
    if (strcmp(text, "auto") == 0)
        n = processors_available("");
    else if (!number_parse(text, 1, most, false, &n))
        return error_set(error, ERROR_REQUEST,
                         "%s is '%s'; it must be auto or a whole number from 1 to %u", name, text,
                         most);
    n = n > most ? most : n;
    memcpy(value, &n, sizeof n);
    return true;
}

static bool set_threads(void *value, const char *text, struct error *error)
{
    return read_threads(value, text, "threads", POOL_MAX_THREADS, error);
}

static bool set_native_threads(void *value, const char *text, struct error *error)
{
    _Static_assert(PROTOCOL_MOST_NATIVE_THREADS == RENDERER_MAX_THREADS, "clients know the range");
    return read_threads(value, text, "native-threads", RENDERER_MAX_THREADS, error);
}

static bool set_native_isa(void *value, const char *text, struct error *error)
{
    static const char *const SETS[] = {PROTOCOL_NATIVE_ISAS, NULL};
    int chosen;
    if (!set_choice(&chosen, text, "native-isa", SETS, error))
        return false;
    snprintf(value, SERVICE_ISA_BYTES, "%s", text);
    return true;
}

static bool set_session_fd(void *value, const char *text, struct error *error)
{
    uint64_t number = 0;
    struct stat file;
    int fd = -1;
    if (strcmp(text, "none") != 0) {
        if (!number_parse(text, 0, 1000000, false, &number))
            return error_set(error, ERROR_REQUEST,
                             "session-fd is '%s'; it must be a whole number from 0 to 1000000",
                             text);
        fd = (int)number;
        if (fstat(fd, &file) < 0 || !S_ISSOCK(file.st_mode))
            return error_set(error, ERROR_REQUEST, "session-fd %s is no open socket", text);
    }
    memcpy(value, &fd, sizeof fd);
    return true;
}

/* --- the table */

#define VALUE(member) offsetof(struct settings, member), sizeof(((struct settings *)0)->member)

static const struct option_row OWN_ROWS[] = {
    {"listen", "ADDRESS", OPTION_LIST, OPTION_IN_FILE, VALUE(service.listen), 0, 0, NULL, NULL,
     "address to listen on: unix:PATH, tcp:HOST:PORT (loopback only) or\n"
     "tls:HOST:PORT; may be given several times\n"
     "(default: unix:$XDG_RUNTIME_DIR/sheen.sock, else unix:/tmp/sheen-UID/sheen.sock)",
     add_listen},
    {"device", "auto|software|native|N", OPTION_OTHER, OPTION_IN_FILE, VALUE(service.device), 0, 0,
     NULL, "auto",
     "device that draws: auto, a GPU if there is one, else the processors; software or\n"
     "native, the processors without OpenGL; N, the EGL device of this number, which\n"
     "includes Mesa's software device",
     set_device},
    {"native-threads", "N", OPTION_OTHER, OPTION_IN_FILE, VALUE(service.n_native_threads), 0, 0,
     NULL, "auto",
     "threads that draw if there is no GPU, 1 to 64; auto: one for each processor that\n"
     "this process and its control group may use. The number does not change pictures",
     set_native_threads},
    {"native-isa", "auto|v2|v3|v4", OPTION_OTHER, OPTION_IN_FILE, VALUE(service.native_isa), 0, 0,
     NULL, "auto",
     "x86-64 instructions to draw with if there is no GPU: v2 (SSE4.2), v3 (AVX2 and FMA)\n"
     "or v4 (AVX-512); auto: the best that the processor has. Pictures of different sets\n"
     "differ by rounding: give all machines the same set to get the same pictures",
     set_native_isa},
    {"threads", "N", OPTION_OTHER, OPTION_IN_FILE, VALUE(service.n_threads), 0, 0, NULL, "auto",
     "number of threads that build tables and encode, 1 to 256; auto: as for\n"
     "native-threads",
     set_threads},
    {"allow-uid", "UID", OPTION_LIST, OPTION_IN_FILE | OPTION_RELOADS, VALUE(service.access.uids),
     0, 0, NULL, NULL,
     "user who may connect to the Unix sockets; may be given several times, up to 64.\n"
     "With --allow-uid or --allow-gid nobody else may connect, not even the daemon's own\n"
     "user (default: all users that the socket file's permissions allow: its owner)",
     add_id},
    {"allow-gid", "GID", OPTION_LIST, OPTION_IN_FILE | OPTION_RELOADS, VALUE(service.access.gids),
     0, 0, NULL, NULL,
     "group whose members may connect to the Unix sockets; may be given several times", add_id},
    {"tls-cert", "FILE", OPTION_TEXT, OPTION_IN_FILE | OPTION_RELOADS,
     VALUE(service.access.tls_cert), 0, 0, NULL, NULL,
     "PEM file with the certificate for TLS addresses, followed by its authorities", NULL},
    {"tls-key", "FILE", OPTION_TEXT, OPTION_IN_FILE | OPTION_RELOADS, VALUE(service.access.tls_key),
     0, 0, NULL, NULL, "PEM file with the key of --tls-cert", NULL},
    {"client-ca", "FILE", OPTION_TEXT, OPTION_IN_FILE | OPTION_RELOADS,
     VALUE(service.access.client_ca), 0, 0, NULL, NULL,
     "PEM file with the authority whose client certificates are admitted over TLS", NULL},
    {"tls-crl", "FILE", OPTION_TEXT, OPTION_IN_FILE | OPTION_RELOADS, VALUE(service.access.tls_crl),
     0, 0, NULL, NULL,
     "PEM file with the authority's list of revoked client certificates. An expired list\n"
     "admits no certificate (default: none; a certificate is valid until it expires)",
     NULL},
    {"tokens", "FILE", OPTION_TEXT, OPTION_IN_FILE | OPTION_RELOADS, VALUE(service.access.tokens),
     0, 0, NULL, NULL,
     "file with lines 'NAME HASH YYYY-MM-DD': tokens that are admitted over TLS, each\n"
     "until the end of its day; with --client-ca, a certificate or a token is enough",
     NULL},
    {"proxy-from", "ADDRESS[/BITS]", OPTION_LIST, OPTION_IN_FILE | OPTION_RELOADS,
     VALUE(service.proxy_from), 0, 0, NULL, NULL,
     "load balancer whose connections must begin with a header of PROXY protocol version 2\n"
     "that has the client's address; may be given several times, up to 16. Such a header is\n"
     "refused from all other addresses (default: none)",
     add_proxy_from},
    {"share-models", NULL, OPTION_FLAG, OPTION_IN_FILE, VALUE(service.share_models), 0, 0, NULL,
     NULL,
     "every client may use every model whose SHA-256 it knows (default: only the model's\n"
     "owner may: a user, a certificate's subject and issuer, or a token's name; others only\n"
     "if the owner has uploaded it with --share)",
     NULL},
    {"models", "DIR", OPTION_TEXT, OPTION_IN_FILE, VALUE(service.models), 0, 0, NULL, NULL,
     "folder of model files that clients may name as server:NAME; symbolic links and other\n"
     "mounts are not followed (default: none)",
     NULL},
    {"stuck-after", "SECONDS", OPTION_NUMBER, OPTION_IN_FILE | OPTION_RELOADS,
     VALUE(service.stuck_s), 1, 86400, "seconds", "60",
     "a thread that works on one task for longer counts as stuck: /healthz fails, and\n"
     "the service manager's watchdog is not fed; seconds",
     NULL},
    {"metrics", "ADDRESS", OPTION_OTHER, OPTION_IN_FILE, VALUE(service.metrics), 0, 0, NULL, NULL,
     "serve GET /metrics, /healthz and /readyz at this address: unix:PATH or\n"
     "tcp:HOST:PORT, only on the loopback without --metrics-open (default: none)",
     set_metrics},
    {"metrics-open", NULL, OPTION_FLAG, OPTION_IN_FILE, VALUE(service.metrics_open), 0, 0, NULL,
     NULL,
     "--metrics may be an address beyond the loopback, without TLS: everybody who reaches it\n"
     "can read counts, times, the device and the version, but no name of a model, a file or\n"
     "a client",
     NULL},
    {"log-level", "LEVEL", OPTION_OTHER, OPTION_IN_FILE | OPTION_RELOADS, VALUE(service.log_level),
     0, 0, NULL, "info",
     "error, warn, info (sessions, refused requests) or debug (every request),\n"
     "on standard error",
     set_log_level},
    {"log-format", "FORMAT", OPTION_OTHER, OPTION_IN_FILE | OPTION_RELOADS,
     VALUE(service.log_format), 0, 0, NULL, "logfmt", "logfmt or json", set_log_format},
    {"config", "FILE", OPTION_TEXT, 0, VALUE(config), 0, 0, NULL, NULL,
     "file with lines 'name = value' with the names above, each once, except those that may\n"
     "be given several times; options of the command line replace those of the file",
     NULL},
    {"check-config", NULL, OPTION_FLAG, 0, VALUE(check_config), 0, 0, NULL, NULL,
     "check the options and the file, then exit", NULL},
    {"session-fd", "N", OPTION_OTHER, 0, VALUE(service.session_fd), 0, 0, NULL, "none",
     "serve only this connected socket, and end with it", set_session_fd},
    {"hash-token", "NAME:DAY", OPTION_ACTION, 0, 0, 0, 0, 0, NULL, NULL,
     "read a token from standard input and print its line for --tokens, valid until the end\n"
     "of the day YYYY-MM-DD; 'openssl rand -base64 32' makes a token",
     hash_token},
    {"version", NULL, OPTION_ACTION, 0, 0, 0, 0, 0, NULL, NULL, "print the version and exit", NULL},
    {"help", NULL, OPTION_ACTION, 0, 0, 0, 0, 0, NULL, NULL, "print this and exit", NULL},
};
#define N_OWN_ROWS (sizeof OWN_ROWS / sizeof *OWN_ROWS)

/* A reload may change limits in seconds only: other parts depend on the rest since the start. */
static void fill_limit(struct option_row *row, const struct limits_row *limit,
                       char initial[static LIMITS_TEXT_BYTES])
{
    limits_format(limit, limit->fallback, initial);
    *row = (struct option_row){
        .name = limit->name,
        .argument = limits_argument(limit),
        .type = OPTION_LIMIT,
        .flags = OPTION_IN_FILE | (limit->unit == UNIT_SECONDS ? OPTION_RELOADS : 0u),
        .offset = offsetof(struct settings, service.limits) + limit->offset,
        .size = sizeof(uint64_t),
        .min = limit->low,
        .max = limit->high,
        .initial = initial,
        .help = limit->help,
    };
}

static struct option_row rows[OPTION_MAX_ROWS]; /* the options, then the limits; filled once */

const struct limits_row *option_limit(const struct option_row *row)
{
    return row->type == OPTION_LIMIT ? &LIMITS[row - rows - N_OWN_ROWS] : NULL;
}

const struct option_row *option_rows(size_t *n)
{
    static char initial[OPTION_MAX_ROWS][LIMITS_TEXT_BYTES];
    *n = N_OWN_ROWS + N_LIMITS;
    if (rows[0].name)
        return rows;
    for (size_t i = 0; i < N_LIMITS; i++)
        fill_limit(&rows[N_OWN_ROWS + i], &LIMITS[i], initial[i]);
    memcpy(rows, OWN_ROWS, sizeof OWN_ROWS);
    return rows;
}

const char *option_help(const struct option_row *row, char text[static OPTION_HELP_BYTES])
{
    char range[LIMITS_RANGE_BYTES + 2] = "", numbers[64] = "", initial[192] = "";
    if (row->type == OPTION_NUMBER)
        snprintf(numbers, sizeof numbers, ", %llu to %llu", (unsigned long long)row->min,
                 (unsigned long long)row->max);
    if (option_limit(row)) {
        memcpy(range, "; ", 2);
        limits_range(option_limit(row), range + 2);
    }
    if (row->initial)
        snprintf(initial, sizeof initial, " (default: %s%s)", row->initial, range);
    snprintf(text, OPTION_HELP_BYTES, "%s%s%s", row->help, numbers, initial);
    return text;
}

static bool set_number(const struct option_row *row, void *value, const char *text,
                       struct error *error)
{
    uint64_t n;
    if (!number_parse(text, row->min, row->max, false, &n))
        return error_set(
            error, ERROR_REQUEST, "%s is '%s'; it must be a whole number of %s from %llu to %llu",
            row->name, text, row->unit, (unsigned long long)row->min, (unsigned long long)row->max);
    memcpy(value, &n, sizeof n);
    return true;
}

static bool set_text(const struct option_row *row, char *value, const char *text,
                     struct error *error)
{
    if (*text == 0 || strlen(text) >= row->size)
        return error_set(error, ERROR_REQUEST, "%s must be a text of 1 to %zu bytes", row->name,
                         row->size - 1);
    /* strncpy() fills the rest with zeros: values are compared byte by byte */
    strncpy(value, text, row->size);
    return true;
}

static bool set_flag(const struct option_row *row, bool *value, const char *text,
                     struct error *error)
{
    bool yes = strcmp(text, "yes") == 0;
    if (!yes && strcmp(text, "no") != 0)
        return error_set(error, ERROR_REQUEST, "%s is '%s'; it must be yes or no", row->name, text);
    *value = yes;
    return true;
}

bool option_set(const struct option_row *row, struct settings *settings, const char *text,
                struct error *error)
{
    void *value = (char *)settings + row->offset;
    switch (row->type) {
    case OPTION_NUMBER:
        return set_number(row, value, text, error);
    case OPTION_LIMIT:
        return limits_set(&settings->service.limits, option_limit(row), text, error);
    case OPTION_TEXT:
        return set_text(row, value, text, error);
    case OPTION_FLAG:
        return set_flag(row, value, text, error);
    case OPTION_LIST:
    case OPTION_OTHER:
        return row->set(value, text, error);
    case OPTION_ACTION:
        break;
    }
    return error_set(error, ERROR_REQUEST, "%s takes no value", row->name);
}
