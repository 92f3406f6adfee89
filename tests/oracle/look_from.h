/* Converts the oracles' vectors and views to a request for the renderer in this process. */
#ifndef SHEEN_TESTS_ORACLE_LOOK_FROM_H
#define SHEEN_TESTS_ORACLE_LOOK_FROM_H

#include "tests/oracle/renderer.h"
#include "tests/oracle/vec.h"
#include "tests/oracle/view.h"

inline void put(vec3 from, double to[3])
{
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

/* Sets the request's camera to the view's; its size in pixels is unchanged. */
inline void look_from(const view &view, frame_request *request)
{
    request->camera.kind = view.orthographic ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE;
    put(view.eye, request->camera.eye);
    put(view.target, request->camera.target);
    put(view.up, request->camera.up);
    request->camera.fov_deg = view.fov_deg;
    request->camera.ortho_height = view.ortho_height;
}

#endif
