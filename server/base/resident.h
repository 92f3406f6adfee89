/* The memory that this process has in use. Any thread. */
#ifndef SHEEN_BASE_RESIDENT_H
#define SHEEN_BASE_RESIDENT_H

#include <stdint.h>

/* Resident memory in bytes, 0 when /proc cannot be read. */
uint64_t resident_bytes(void);

#endif
