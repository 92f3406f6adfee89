/* Messages whose body is a nanopb struct: encoding, decoding, and the checks that nanopb does not
 * make.
 *
 * All types have a body struct, except UPLOAD_CHUNK and DATA (raw bytes), and STATS_QUERY and
 * CANCEL (empty). HELLO's struct stands behind the 32-byte model id and has functions of its own.
 *
 * Pure: buffers of the caller, no allocation, no state, any thread. */
#ifndef SHEEN_PROTOCOL_MESSAGE_H
#define SHEEN_PROTOCOL_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/frame.h"
#include "protocol/limits.h"
#include "sheen.pb.h"

/* Room for any encoded message with its header, except UPLOAD_CHUNK and DATA. */
#define MESSAGE_BUFFER_BYTES (MESSAGE_HEADER_BYTES + PROTOCOL_MAX_LARGE_BODY_BYTES)
#define MESSAGE_TEXT_BYTES 240 /* size of a text written by a check, with its 0 */

/* Writes header and body of a message to `buffer`, and the total length to *length. `body` points
 * to the type's struct (sheen_Render for MESSAGE_RENDER and so on); NULL for types with an empty
 * body. False if the message does not fit, a string has no end, or the type has no struct. */
bool message_encode(uint8_t type, uint32_t seq, const void *body, uint8_t *buffer, size_t capacity,
                    size_t *length);
bool message_hello_encode(uint32_t seq, const uint8_t model_id[static MODEL_ID_BYTES],
                          const sheen_Hello *hello, uint8_t *buffer, size_t capacity,
                          size_t *length);

/* Decodes a body, without its header, into the type's struct. False if it is cut short, lacks a
 * required field or exceeds a bound, or if the type has no struct; then *body is undefined. */
bool message_decode(uint8_t type, const uint8_t *bytes, size_t length, void *body);
bool message_hello_decode(const uint8_t *bytes, size_t length,
                          uint8_t model_id[static MODEL_ID_BYTES], sheen_Hello *hello);

/* Finds out why message_decode() or message_hello_decode() refused a body, and writes one line to
 * `text`. True: the line names a field that exceeds its bound (with the bound), one that is
 * missing, or a text with a zero byte in it. False: there is none of these, and the line says that
 * the body is malformed. Reads no further than `length`, whatever the bytes are. */
bool message_find_fault(uint8_t type, const uint8_t *bytes, size_t length,
                        char text[static MESSAGE_TEXT_BYTES]);

/* The nanopb schema of a type's struct; NULL for types without a struct, and for HELLO. */
const pb_msgdesc_t *message_fields(uint8_t type);

/* Checks of decoded requests, for the daemon. On failure they return false and write one line to
 * `text`, which names the field and its range and can be sent as an ERROR with ERROR_REQUEST. */
bool message_check_hello(const sheen_Hello *hello, char text[static MESSAGE_TEXT_BYTES]);
bool message_check_upload_begin(const sheen_UploadBegin *begin,
                                char text[static MESSAGE_TEXT_BYTES]);
bool message_check_model_query(const sheen_ModelQuery *query, char text[static MESSAGE_TEXT_BYTES]);
/* The size is checked against the device's limits; a client that does not know them passes
 * UINT32_MAX. After true every float of the request is finite and in range, every enum is known,
 * the planes suit the encoding, and codec_layout_init() accepts the request's size with all planes
 * of message_render_planes(). */
bool message_check_render(const sheen_Render *render, uint32_t max_width_px, uint32_t max_height_px,
                          char text[static MESSAGE_TEXT_BYTES]);

/* Requests of computations. The scene is checked as a RENDER, without the device's limits. */
bool message_check_find_breaks(const sheen_FindBreaks *asked, char text[static MESSAGE_TEXT_BYTES]);
bool message_check_compare(const sheen_Compare *asked, char text[static MESSAGE_TEXT_BYTES]);
bool message_check_trace_lines(const sheen_TraceLines *asked, char text[static MESSAGE_TEXT_BYTES]);

/* The planes that the daemon must draw for a frame: those requested, and those from which its false
 * colour is painted. */
uint32_t message_render_planes(const sheen_Render *render);

/* Checks a decoded answer, for the client: strings are UTF-8 without control characters (they reach
 * a terminal), floats are finite, enums are known. `type` must be one that a server sends. False
 * with a text that names the field. */
bool message_check_answer(uint8_t type, const void *body, char text[static MESSAGE_TEXT_BYTES]);

/* True for well-formed UTF-8 (no overlong form, no surrogate, at most U+10FFFF) without control
 * characters; newlines are allowed if `lines`. */
bool message_is_text(const char *text, bool lines);

/* Changes a text in place so that it passes message_is_text(): if it does not, every byte that is
 * not a printable ASCII character (nor a newline, if `lines`) becomes '?'. Names and lines of files
 * may hold any bytes, and cutting a text may split a character. */
void message_make_text(char *text, bool lines);

#endif
