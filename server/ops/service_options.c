/* Checks the options of the main service together. */
#include <unistd.h>

#include "server/assets/model_file.h"
#include "server/ops/service.h"

enum listener_reach service_metrics_reach(const struct service_options *options)
{
    return options->metrics_open ? LISTENER_ANYWHERE : LISTENER_LOOPBACK;
}

/* Metrics are served without TLS, so only this machine may read them, or, with --metrics-open,
 * everybody who reaches the address. */
static bool check_metrics(const struct service_options *options, struct error *error)
{
    const struct address *address = &options->metrics.address[0];
    if (options->metrics.n == 0)
        return true;
    if (address->kind == ADDRESS_TLS)
        return error_set(error, ERROR_REQUEST,
                         "metrics are served without TLS, and not at tls:%s:%u: give a Unix "
                         "socket, unix:PATH, or an address on loopback, as tcp:127.0.0.1:%u",
                         address->host, (unsigned)address->port, (unsigned)address->port);
    if (listener_check(address, service_metrics_reach(options), error))
        return true;
    return error->kind == ERROR_REQUEST && /* else a host name could not be resolved */
           error_set(error, ERROR_REQUEST,
                     "metrics go to this machine alone, and not to tcp:%s:%u: give a Unix socket, "
                     "unix:PATH, or an address on loopback, as tcp:127.0.0.1:%u; or say with "
                     "--metrics-open that whoever reaches that address may read them",
                     address->host, (unsigned)address->port, (unsigned)address->port);
}

bool service_options_check(const struct service_options *options, struct error *error)
{
    if (options->session_fd >= 0 && options->listen.n > 0)
        return error_set(error, ERROR_REQUEST, "--session-fd and --listen exclude each other");
    bool tls = false;
    for (size_t i = 0; i < options->listen.n; i++) {
        if (!listener_check(&options->listen.address[i], LISTENER_LOOPBACK, error))
            return false;
        tls |= options->listen.address[i].kind == ADDRESS_TLS;
    }
    if (!check_metrics(options, error))
        return false;
    int models_fd = *options->models ? model_folder_open(options->models, error) : -1;
    if (models_fd >= 0)
        close(models_fd);
    else if (*options->models)
        return false;
    struct access *access = access_create(&options->access, error);
    bool ok = access && (!tls || access_can_tls(access, error));
    access_destroy(access);
    return ok;
}
