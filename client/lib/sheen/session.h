/* Connections to a daemon, which may be a private one, and what the daemon says about itself.
 * sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_SESSION_H
#define SHEEN_PUBLIC_SESSION_H

#include "base.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEEN_DECLARATIONS_BEGIN

struct sheen_session;

struct sheen_connect_options {
    size_t size;
    /* unix:PATH, tcp:HOST:PORT or tls:HOST:PORT; NULL: start a private daemon. */
    const char *address;
    /* Private daemon: the device that draws. "auto" or NULL: a GPU, else the processors; "software"
     * or "native": the processors; or the number of an EGL device. */
    const char *device;
    /* Private daemon: the memory for files, tables and frames together, in bytes, at least 36 MiB;
     * 0: half of the memory that this machine has or that the program's control group allows. */
    uint64_t memory_budget_bytes;
    uint32_t timeout_ms;         /* longest time without a transferred byte; 0: no limit */
    uint32_t connect_timeout_ms; /* the same during sheen_connect(); 0: timeout_ms */
    /* A load balancer may choose a node by this id: that of the model that will be requested, or,
     * for a model file at the server, sheen_file_id() of the text "server:NAME". Zeros: any
     * node. */
    uint8_t model_id[SHEEN_ID_BYTES];
    /* For tls: addresses: PEM files. The daemon's certificate is verified against `ca`; NULL:
     * against the authorities that the system trusts. The daemon may demand a certificate (cert and
     * key) or a token from the client. */
    const char *ca, *cert, *key;
    const char *token; /* only sent over TLS; NULL: none */
    /* Other clients may use the files that this session uploads, if they know their SHA-256. */
    bool share;
    /* Private daemon without a GPU: the x86-64 level of the vector code, "v2", "v3" or "v4"; "auto"
     * or NULL: the best that the processor has. */
    const char *native_isa;
    /* Private daemon without a GPU: the number of threads that draw, 1 to 64; 0: one for each
     * processor that it may use. */
    uint32_t native_threads;
};
#define SHEEN_CONNECT_DEFAULTS                                                                     \
    ((struct sheen_connect_options){.size = sizeof(struct sheen_connect_options),                  \
                                    .timeout_ms = 300000})
/* Writes the defaults into a struct of `size` bytes. */
void sheen_connect_options_init(struct sheen_connect_options *options, size_t size);

/* Connects to a daemon, or starts a private one, and exchanges greetings. On success *session is to
 * be closed with sheen_close(); on failure it is NULL. The status is then
 *
 *   SHEEN_BAD_ARGUMENT   a bad option, or a certificate or key that cannot be read
 *   SHEEN_NO_SERVER      cannot connect, or cannot start a private daemon
 *   SHEEN_LOST_SERVER    the daemon closed the connection, or the private daemon ended at once
 *   SHEEN_DEVICE_FAILED  the private daemon found no usable device
 *   SHEEN_BAD_PEER, SHEEN_BAD_VERSION, SHEEN_TIMEOUT, SHEEN_OVERLOADED, SHEEN_NO_MEMORY
 *
 * A private daemon is a child process on a socket pair. Its program is $SHEEN_DAEMON, else `sheend`
 * in the folder of the running program, else `sheend` on the PATH. It ends when the session is
 * closed. It inherits no file except its socket. Its standard error is kept, and explains its end
 * if it dies. */
enum sheen_status sheen_connect(struct sheen_session **session,
                                const struct sheen_connect_options *options,
                                struct sheen_error *error);

/* Closes the session; ends its private daemon and waits for it. NULL is safe. */
void sheen_close(struct sheen_session *session);

#define SHEEN_MAX_IN_FLIGHT 64 /* largest number of requests in flight with any daemon */

/* What the daemon says about itself. The strings are valid as long as the session. */
struct sheen_server {
    size_t size;
    const char *version;
    const char *device, *driver;
    bool software;
    uint32_t max_width_px, max_height_px;
    uint64_t max_upload_bytes;
    uint32_t max_in_flight; /* limit of requests in flight, 1 to SHEEN_MAX_IN_FLIGHT */
};
#define SHEEN_SERVER_DEFAULTS ((struct sheen_server){.size = sizeof(struct sheen_server)})

/* Fills in *server; sends nothing. Fails only with SHEEN_BAD_ARGUMENT. */
enum sheen_status sheen_get_server(const struct sheen_session *session, struct sheen_server *server,
                                   struct sheen_error *error);

/* The session's socket, for poll() or an event loop. Only the library may read, write or close it.
 * *events is set to the events to wait for before the next sheen_try_receive(): POLLIN, or POLLOUT
 * while TLS must write first. Returns -1 and sets *events to 0 if the session is NULL or has
 * failed. */
int sheen_descriptor(const struct sheen_session *session, short *events);

/* report() is called during long calls, by the thread that made the call: for uploads with the
 * stage "upload" and bytes, else with a stage that the daemon reports, such as "tables" with faces.
 * `done` may reach `total`; `total` is 0 where it is not known. report() must not call functions
 * with the session. Every `progress` argument may be NULL. */
struct sheen_progress {
    void (*report)(void *context, const char *stage, uint64_t done, uint64_t total);
    void *context;
};

static inline struct sheen_connect_options sheen_connect_defaults(void)
{
    struct sheen_connect_options options;
    sheen_connect_options_init(&options, sizeof(options));
    return options;
}

static inline struct sheen_server sheen_server_defaults(void)
{
    struct sheen_server server;
    sheen_struct_init(&server, sizeof(server));
    return server;
}

SHEEN_DECLARATIONS_END

#endif
