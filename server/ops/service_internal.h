/* What the files of the service know of each other: service_run.c has its life from service_create()
 * on, service_clients.c listeners and new clients, service_start.c devices, threads and what each room
 * needs of the others. Internal to the folder. Thread: the loop's. */
#ifndef SHEEN_OPS_SERVICE_INTERNAL_H
#define SHEEN_OPS_SERVICE_INTERNAL_H

#include <sys/queue.h>

#include "server/net/proxied.h"
#include "server/ops/daemon.h"
#include "server/ops/gpu_loss_log.h"
#include "server/ops/monitor.h"
#include "server/ops/service.h"

struct service {
    struct service_options options; /* the options in force */
    struct service_reloader reloader;
    struct daemon daemon;
    struct monitor *monitor; /* NULL with a single session */
    struct listener *listeners[SERVICE_MAX_LISTENERS];
    size_t n_listeners;
    struct proxied *proxied; /* NULL with a single session, and while draining */
    struct loop_source signals;
    int signal_fd;
    LIST_HEAD(session_list, session) sessions;
    struct gpu_loss_log gpu_losses;
    uint64_t trimmed_us; /* when the block cache was last trimmed */
    enum service_end end;
    uint64_t told_to_end_us;     /* when a signal came; 0: none came, or drain() has been called */
    unsigned batches_since_told; /* batches of events since then */
    bool has_driver;             /* the device draws by a driver, as struct device_try has it */
    bool single;                 /* private daemon: ends with its session */
};

/* service_run.c. Makes the loop, which takes the signals that end or reload the service. Call it
 * before any thread starts. */
bool service_make_loop(struct service *service, struct error *error);

/* service_start.c. Starts all threads, and opens the listeners or the one session. */
bool service_start(struct service *service, struct error *error);

/* service_clients.c. Opens the listeners of the service manager and of the options, and that of health
 * and metrics. */
bool service_open_listeners(struct service *service, struct error *error);
void service_close_listeners(
    struct service *service); /* and connections that have not become sessions */
/* Starts the session of a private daemon over a connected socket, which it takes over. */
bool service_open_session(struct service *service, int fd, struct error *error);
/* Destroys the sessions that have ended. */
void service_settle_sessions(struct service *service);
/* Has a listener paused because there were no descriptors left? */
bool service_rests(const struct service *service);
/* Lets the paused listeners accept again. */
void service_resume_listeners(struct service *service);
bool service_has_tls(const struct service *service); /* a listener of TLS */
/* Writes the addresses of all listeners, separated by ", ". */
void service_list_addresses(const struct service *service, char *text, size_t capacity);

#endif
