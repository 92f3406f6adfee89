/* server/gpu/renderer.h for C++, where renderer_info is a struct and a function, as it may be. */
#ifndef SHEEN_TESTS_ORACLE_RENDERER_H
#define SHEEN_TESTS_ORACLE_RENDERER_H

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
extern "C" {
#include "server/gpu/renderer.h"
}
#pragma GCC diagnostic pop

#endif
