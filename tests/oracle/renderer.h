/* server/render/renderer.h for C++, in which renderer_info is both a struct and a function. Its
 * line_family and line_eye_kind are renamed to renderer_..., because lines.h has its own. */
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
