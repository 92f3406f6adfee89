/* libsheen: exact reflection lines on subdivision surfaces and on bicubic patches, rendered by a
 * daemon (sheend), for programs in C11 and C++17. Programs include this header. It consists of the
 * headers in the folder sheen, one for each task, to which the rules below apply.
 *
 *     struct sheen_error error;
 *     struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS; // a private daemon
 *     struct sheen_request request = SHEEN_REQUEST_DEFAULTS;         // 1280x720, a PNG file
 *     struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
 *     struct sheen_session *session = NULL;
 *     uint8_t *bytes = NULL;
 *     size_t n_bytes;
 *
 *     if (sheen_read_file(SHEEN_FILE_MODEL, "hood.obj", &bytes, &n_bytes, &error))
 *         return show(error.text);
 *     if (!sheen_file_id(bytes, n_bytes, request.model_id))
 *         show("libcrypto failed");
 *     else if (sheen_connect(&session, &options, &error) ||
 *              sheen_upload(session, SHEEN_FILE_MODEL, request.model_id, bytes, n_bytes,
 *                           "hood.obj", NULL, &error) ||
 *              sheen_render(session, &request, NULL, &frame, &error))
 *         show(error.text);
 *     else
 *         fwrite(frame.data, 1, frame.data_bytes, out);
 *     sheen_frame_finish(&frame);
 *     sheen_close(session);
 *     free(bytes);
 *
 * In C++ the defaults are functions: `sheen_request request = sheen_request_defaults();`.
 *
 * Blocking: a call blocks until it is done, until it fails, or until no byte was transferred for
 * `timeout_ms`. A program with its own event loop waits on sheen_descriptor() and receives frames
 * by sheen_try_receive().
 *
 * Failure: functions return SHEEN_OK (0) or another status; then they fill in *error, which may be
 * NULL. After a status for which sheen_status_is_fatal() is true, the only valid call with the
 * session is sheen_close(); after any other status the session can still be used. Arguments are
 * checked: a NULL that is not allowed, NaN and values out of range return SHEEN_BAD_ARGUMENT, and
 * nothing is sent.
 *
 * Ownership: strings and buffers that the program passes are used during the call only. The library
 * owns everything that it returns, except where a comment says otherwise.
 *
 * Compatibility: a later version of the library with the same soname may add members at the end of
 * the structs that begin with `size`, but not of other structs. New members never use padding of the
 * earlier struct, so that `size` tells which members a program has. `size` is the struct's sizeof in
 * the program, which the defaults set, and at least 16. The library never touches bytes beyond it.
 *   - Program compiled with an older sheen.h: members that it does not have get their defaults when the
 *     struct is an argument, and are not written when the struct is a result.
 *   - Program compiled with a newer sheen.h: members that the library does not have must be zero in an
 *     argument (else SHEEN_BAD_ARGUMENT), and are zero in a result.
 * Enumerators keep their numbers.
 *
 * Thread: a session is used by one thread at a time; different sessions are independent. The
 * library raises no SIGPIPE, installs no signal handler and keeps no global state.
 *
 * Units: pixels `_px`, microseconds `_us`, milliseconds `_ms`, degrees `_deg`. Coordinates are in
 * the model file's own units, right-handed. Pixel (0,0) is at the top left. */
#ifndef SHEEN_H
#define SHEEN_H

#include "sheen/base.h"
#include "sheen/session.h"
#include "sheen/files.h"
#include "sheen/model.h"
#include "sheen/scene.h"
#include "sheen/request.h"
#include "sheen/frame.h"
#include "sheen/breaks.h"
#include "sheen/compare.h"
#include "sheen/curves.h"
#include "sheen/stats.h"

#endif
