/* What all headers of libsheen need: what a call returns, the version, and the id of a file.
 * sheen.h has the rules. */
#ifndef SHEEN_PUBLIC_BASE_H
#define SHEEN_PUBLIC_BASE_H

#include <stdbool.h>
#include <stddef.h>

/* Every header declares its names between these two. */
#ifdef __cplusplus
#define SHEEN_EXTERN_C_BEGIN extern "C" {
#define SHEEN_EXTERN_C_END }
#else
#define SHEEN_EXTERN_C_BEGIN
#define SHEEN_EXTERN_C_END
#endif
#if defined(__GNUC__)
#define SHEEN_DECLARATIONS_BEGIN SHEEN_EXTERN_C_BEGIN _Pragma("GCC visibility push(default)")
#define SHEEN_DECLARATIONS_END _Pragma("GCC visibility pop") SHEEN_EXTERN_C_END
#else
#define SHEEN_DECLARATIONS_BEGIN SHEEN_EXTERN_C_BEGIN
#define SHEEN_DECLARATIONS_END SHEEN_EXTERN_C_END
#endif

SHEEN_DECLARATIONS_BEGIN

#define SHEEN_ID_BYTES 32 /* SHA-256 of a file's bytes */

enum sheen_status {
    SHEEN_OK,
    SHEEN_BAD_ARGUMENT,  /* refused by the library, nothing was sent     exit code 2 */
    SHEEN_BAD_REQUEST,   /* refused by the daemon: out of its limits     exit code 2 */
    SHEEN_BAD_MODEL,     /* the cage is bad or not supported             exit code 3 */
    SHEEN_BAD_IMAGE,     /* an image is bad, or a file cannot be written exit code 3 */
    SHEEN_TOO_BIG,       /* the file exceeds the daemon's limit          exit code 3 */
    SHEEN_UNKNOWN_MODEL, /* the daemon does not have the file: upload it exit code 4 */
    /* Not fatal. From sheen_connect() there is no session either way: connect again. */
    SHEEN_OVERLOADED,    /* the daemon is full: try later                exit code 4 */
    SHEEN_SUPERSEDED,    /* a newer request of the same view replaced it exit code 4 */
    SHEEN_CANCELLED,     /* cancelled by sheen_cancel()                  exit code 4 */
    SHEEN_LATE,          /* not drawn within its deadline                exit code 4 */
    SHEEN_GPU_LOST,      /* the daemon's GPU was lost repeatedly         exit code 4 */
    SHEEN_SHUTTING_DOWN, /* fatal: the daemon is shutting down           exit code 4 */
    SHEEN_NO_SERVER,     /* fatal: cannot connect or start a daemon      exit code 4 */
    SHEEN_LOST_SERVER,   /* fatal: the connection broke                  exit code 4 */
    SHEEN_TIMEOUT,       /* fatal: no byte transferred for timeout_ms    exit code 4 */
    SHEEN_BAD_PEER,      /* fatal: the peer broke the protocol           exit code 4 */
    SHEEN_BAD_VERSION,   /* fatal: the peer speaks another major version exit code 4 */
    SHEEN_NO_MEMORY,     /* fatal: the program's memory is short         exit code 4 */
    SHEEN_DEVICE_FAILED, /* EGL or the GPU failed, or there is none      exit code 5 */
    SHEEN_AGAIN,         /* sheen_try_receive(): no complete answer yet  exit code 4 */
};

struct sheen_error {
    enum sheen_status status;
    char text[640]; /* one line of UTF-8 without newline: what failed, where, and what to do */
};

/* The version of the library and of the protocol: "0.1.0, protocol 1.5". A static string. */
const char *sheen_version(void);

/* The exit code with which the `sheen` command ends after this status: 0, 2, 3, 4 or 5. */
int sheen_status_exit_code(enum sheen_status status);
/* True if the session can only be closed after this status. */
bool sheen_status_is_fatal(enum sheen_status status);

/* Zeroes a struct of `size` bytes that begins with `size`, and sets that member: these are the
 * defaults of the structs that the library fills in. For languages that cannot use the macros
 * such as SHEEN_FRAME_DEFAULTS. Does nothing if size is below 16. */
void sheen_struct_init(void *sized_struct, size_t size);

SHEEN_DECLARATIONS_END

#endif
