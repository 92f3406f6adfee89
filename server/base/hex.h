/* Converts bytes to and from lower-case hexadecimal digits, two for each byte. Pure, any thread. */
#ifndef SHEEN_BASE_HEX_H
#define SHEEN_BASE_HEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Writes 2 * n digits and a 0. */
void hex_write(const uint8_t *bytes, size_t n, char *text);
/* Reads exactly n bytes. False if `text` has another length or a character other than lower-case
 * digits; then the contents of `bytes` are undefined. */
bool hex_read(const char *text, uint8_t *bytes, size_t n);

#endif
