/* The peers that a question compares with sheen. A program is linked with the peers
 * (frame_peers.cpp, tables_peers.cpp) or with none (no_peers.cpp). */
#ifndef SHEEN_TESTS_BENCH_PEERS_H
#define SHEEN_TESTS_BENCH_PEERS_H

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/scene.h"

/* A peer that draws a cage with the camera, light and stripes of scene::request(). */
class frame_peer
{
  public:
    virtual ~frame_peer() = default;
    /* Draws the picture and returns its milliseconds. */
    virtual double draw_ms(const frame_request &request) = 0;
    /* The picture's normals: 3 floats for each pixel, top row first; NaN without a hit. */
    virtual std::vector<float> normals(const frame_request &request) = 0;
};

struct frame_peer_kind {
    std::string name;  /* for a column */
    std::string about; /* version and settings */
    /* The features of the cage that it does not support; empty: none. */
    std::function<std::string(const cage &)> lacks;
    /* Prepares a cage for the first picture. `ours` is on the same device, and its context is
     * current. */
    std::function<std::unique_ptr<frame_peer>(const cage &, const drawing &ours)> build;
};
/* has_gl: there is a GL context in which peers can draw. */
std::vector<frame_peer_kind> frame_peers(bool has_gl);

struct tables_peer {
    std::string name;
    std::function<void(const cage &)> build;
};
std::vector<tables_peer> tables_peers();

#endif
