/* Who connects: users of the Unix socket by their uid, others by their address (IPv6 by its /64,
 * which one machine has to itself). What one peer's connections take together is bounded by what
 * is counted here. Thread: the loop's. */
#ifndef SHEEN_ASSETS_CLIENT_QUOTA_H
#define SHEEN_ASSETS_CLIENT_QUOTA_H

#include <stdint.h>

#define PEER_NAME_BYTES 64
#define PEER_TEXT_BYTES 80

struct peer {
    char name[PEER_NAME_BYTES]; /* "user 1000", "127.0.0.1" */
    uint32_t n_connections;
    uint64_t memory_bytes;  /* uploads and long messages under way, frames not yet sent */
    uint64_t patient_bytes; /* of these, stills and batches */
    uint64_t key[2];        /* the module's own */
    unsigned references;
    struct peer *next;
};

#define PEER_BUCKETS 256
struct peers {
    struct peer *bucket[PEER_BUCKETS];
};

/* The peer of a connected socket, with another reference. NULL when memory is short. */
struct peer *peer_get(struct peers *peers, int fd);
struct peer *peer_reference(struct peer *peer);
void peer_put(struct peers *peers, struct peer *peer); /* NULL is safe */

/* Who it is just now, for the log: "unix uid=1000 gid=1000 pid=42", or "192.0.2.1:4711"; "unknown"
 * when the peer has gone. */
void peer_describe(int fd, char text[static PEER_TEXT_BYTES]);

#endif
