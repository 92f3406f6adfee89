/* Messages whose body is a nanopb struct: to bytes, from bytes, and the checks nanopb leaves out.
 *
 * Types with a body struct: all but UPLOAD_CHUNK, DATA (raw bytes), STATS_QUERY and CANCEL
 * (empty).
 * HELLO's struct stands behind the 32-byte model id and has functions of its own.
 * Pure: caller's buffers, no allocation, no state, any thread. */
#ifndef SHEEN_PROTOCOL_MESSAGE_H
#define SHEEN_PROTOCOL_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/frame.h"
#include "protocol/limits.h"
#include "sheen.pb.h"

/* Holds any encoded message with its header, but for UPLOAD_CHUNK and DATA. */
#define MESSAGE_BUFFER_BYTES (MESSAGE_HEADER_BYTES + PROTOCOL_MAX_LARGE_BODY_BYTES)
#define MESSAGE_TEXT_BYTES 240 /* of a check's text, with its 0 */

/* Writes header and body of a message to `buffer` and its whole length to *length. `body` points
 * to the type's struct: sheen_Render for MESSAGE_RENDER and so on; NULL for empty ones. False when
 * it does not fit, a string has no end, or the type has no struct. */
bool message_encode(uint8_t type, uint32_t seq, const void *body, uint8_t *buffer, size_t capacity,
                    size_t *length);
bool message_hello_encode(uint32_t seq, const uint8_t model_id[static MODEL_ID_BYTES],
                          const sheen_Hello *hello, uint8_t *buffer, size_t capacity,
                          size_t *length);

/* Reads a body (without its header) into the type's struct. False when it is cut short, lacks a
 * required field, goes over a bound, or the type has no struct; *body is then undefined. */
bool message_decode(uint8_t type, const uint8_t *bytes, size_t length, void *body);
bool message_hello_decode(const uint8_t *bytes, size_t length,
                          uint8_t model_id[static MODEL_ID_BYTES], sheen_Hello *hello);

/* Says why one of these two refused a body, in one line: the field that is over its bound, with the
 * bound, or the one that is missing, or the text with a zero byte in it; then true. False: the body
 * has none of these, and the line says that it is not well-formed. Reads no further than `length`,
 * whatever the bytes are. */
bool message_find_fault(uint8_t type, const uint8_t *bytes, size_t length,
                        char text[static MESSAGE_TEXT_BYTES]);

/* The schema of a type's struct; NULL for types without, and for HELLO. */
const pb_msgdesc_t *message_fields(uint8_t type);

/* Checks of decoded requests, for the daemon. False writes to `text` one line that names the field
 * and its range, fit for an ERROR message with ERROR_REQUEST. */
bool message_check_hello(const sheen_Hello *hello, char text[static MESSAGE_TEXT_BYTES]);
bool message_check_upload_begin(const sheen_UploadBegin *begin,
                                char text[static MESSAGE_TEXT_BYTES]);
bool message_check_model_query(const sheen_ModelQuery *query, char text[static MESSAGE_TEXT_BYTES]);
/* Sizes are checked against the device's limits (a client that does not know them says
 * UINT32_MAX). After true every float of the request is finite and in range, enums are known,
 * the planes suit the encoding, and codec_layout_init() takes the request's size and all planes
 * that it is made of. */
bool message_check_render(const sheen_Render *render, uint32_t max_width_px, uint32_t max_height_px,
                          char text[static MESSAGE_TEXT_BYTES]);

/* The planes that a frame is made of: those asked for, and those that its false colour is painted
 * from. */
uint32_t message_render_planes(const sheen_Render *render);

/* Checks a decoded answer, for the client: strings are UTF-8 free of control characters (they reach
 * a terminal), floats finite, enums known. `type` is one that a server sends. False names the
 * field. */
bool message_check_answer(uint8_t type, const void *body, char text[static MESSAGE_TEXT_BYTES]);

/* Well-formed UTF-8 (no overlong form, no surrogate, at most U+10FFFF) without control characters;
 * newlines pass if `lines`. */
bool message_is_text(const char *text, bool lines);

/* Makes a text pass message_is_text(), in place: where it does not, every byte that is no printable
 * ASCII character (nor a newline, if `lines`) becomes '?'. Names and lines out of files may hold
 * any bytes, and cutting a text may split a character. */
void message_make_text(char *text, bool lines);

#endif
