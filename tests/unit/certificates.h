/* Certificates for one test run, in their own folder, made by the openssl command. */
#ifndef SHEEN_TESTS_CERTIFICATES_H
#define SHEEN_TESTS_CERTIFICATES_H

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct certificates {
    char folder[64];
    /* The authority; a certificate for a server at localhost and 127.0.0.1. */
    char ca[96], cert[96], key[96];
    char client_cert[96], client_key[96];
};

static inline int __attribute__((format(printf, 1, 2))) shell(const char *format, ...)
{
    char command[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    return system(command);
}

/* Makes one certificate of the authority, with `more` options. */
static inline int certificate_make(const struct certificates *c, const char *name, const char *more)
{
    return shell("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 "
                 "-keyout %s/%s.key -out %s/%s.pem -subj /CN=%s %s 2>%s/said",
                 c->folder, name, c->folder, name, name, more, c->folder);
}

/* Makes all certificates. 0 on success. */
static inline int certificates_init(struct certificates *c)
{
    char by_ca[256], server[512];
    strcpy(c->folder, "/tmp/sheen-test-XXXXXX");
    if (!mkdtemp(c->folder))
        return 1;
    snprintf(c->ca, sizeof c->ca, "%s/authority.pem", c->folder);
    snprintf(c->cert, sizeof c->cert, "%s/server.pem", c->folder);
    snprintf(c->key, sizeof c->key, "%s/server.key", c->folder);
    snprintf(c->client_cert, sizeof c->client_cert, "%s/anna.pem", c->folder);
    snprintf(c->client_key, sizeof c->client_key, "%s/anna.key", c->folder);
    snprintf(by_ca, sizeof by_ca, "-CA %s -CAkey %s/authority.key", c->ca, c->folder);
    snprintf(server, sizeof server, "%s -addext subjectAltName=DNS:localhost,IP:127.0.0.1", by_ca);
    return certificate_make(c, "authority", "") || certificate_make(c, "server", server) ||
           certificate_make(c, "anna", by_ca);
}

static inline void certificates_finish(const struct certificates *c)
{
    if (shell("rm -r %s", c->folder) != 0)
        fprintf(stderr, "%s stays\n", c->folder);
}

#endif
