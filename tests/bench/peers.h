/* Those whom a question sets beside us. A program is linked with the peers themselves
 * (frame_peers.cpp, tables_peers.cpp) or with none (no_peers.cpp). */
#ifndef SHEEN_TESTS_BENCH_PEERS_H
#define SHEEN_TESTS_BENCH_PEERS_H

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/scene.h"

/* One that draws a cage: the camera, light and stripes of scene::request(). */
class frame_peer
{
  public:
    virtual ~frame_peer() = default;
    /* The milliseconds that the picture took. */
    virtual double draw_ms(const frame_request &request) = 0;
    /* The picture's normals, 3 floats a pixel, rows top first; NaN where nothing is hit. */
    virtual std::vector<float> normals(const frame_request &request) = 0;
};

struct frame_peer_kind {
    std::string name;  /* for a column */
    std::string about; /* version, and what it was asked for */
    /* What of the cage it has no word for; empty: nothing. */
    std::function<std::string(const cage &)> lacks;
    /* What a cage costs it before its first picture is here; `ours` is on the same device, whose
     * context is current. */
    std::function<std::unique_ptr<frame_peer>(const cage &, const drawing &ours)> build;
};
/* has_gl: whether the drawings beside them have a GL context that peers may draw in. */
std::vector<frame_peer_kind> frame_peers(bool has_gl);

struct tables_peer {
    std::string name;
    std::function<void(const cage &)> build;
};
std::vector<tables_peer> tables_peers();

#endif
