/* Whom an asset belongs to. */
#ifndef SHEEN_BASE_OWNER_H
#define SHEEN_BASE_OWNER_H

#define OWNER_BYTES 32 /* SHA-256 of a client's identity (server/net/access.h) */

#endif
