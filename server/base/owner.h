/* The size of the identifier that says to whom an asset belongs. */
#ifndef SHEEN_BASE_OWNER_H
#define SHEEN_BASE_OWNER_H

#define OWNER_BYTES 32 /* the SHA-256 of a client's identity (server/net/access.h) */

#endif
