/* server/render/renderer.h for C++, where renderer_info is a struct and a function, as it may be.
 * Its line_family and line_eye_kind are called renderer_... here: lines.h has its own. */
#ifndef SHEEN_TESTS_ORACLE_RENDERER_H
#define SHEEN_TESTS_ORACLE_RENDERER_H

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#define line_family renderer_line_family
#define line_eye_kind renderer_line_eye_kind
extern "C" {
#include "server/ops/device_choice.h"
#include "server/render/renderer.h"
#include "server/scene/defaults.h"
}
#undef line_family
#undef line_eye_kind
#pragma GCC diagnostic pop

#endif
