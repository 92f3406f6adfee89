#include "tests/bench/peers.h"

#include "tests/bench/bench.h"
#include "tests/bench/embree.h"
#include "tests/bench/osd_drawing.h"

namespace
{

class embree_peer : public frame_peer
{
    embree_scene scene;
    embree_picture picture;

  public:
    explicit embree_peer(const cage &cage) : scene(cage, 4, bench_threads)
    {
    }
    double draw_ms(const frame_request &request) override
    {
        return time_ms([&] { scene.render(request, false, &picture); });
    }
    std::vector<float> normals(const frame_request &request) override
    {
        scene.render(request, true, &picture);
        return picture.normals;
    }
};

const int osd_level = 6;
const double osd_edge_px = 8;

class osd_peer : public frame_peer
{
    osd_drawing drawing;
    const bool by_device;

  public:
    osd_peer(const cage &cage, const class drawing &ours)
        : drawing(cage, osd_level, osd_edge_px, ours.info().software),
          by_device(ours.info().timed_by_device)
    {
    }
    double draw_ms(const frame_request &request) override
    {
        return drawing.draw_ms(request, by_device);
    }
    std::vector<float> normals(const frame_request &request) override
    {
        return drawing.normals(request);
    }
};

} // namespace

std::vector<frame_peer_kind> frame_peers(bool has_gl)
{
    frame_peer_kind embree, osd;
    embree.name = "Embree";
    embree.about = embree_scene::version() + ", tessellation rate 4, " +
                   std::to_string(bench_threads) + " threads";
    embree.lacks = embree_lacks;
    embree.build = [](const cage &cage, const drawing &) {
        return std::make_unique<embree_peer>(cage);
    };
    osd.name = "OpenSubdiv";
    osd.about = osd_drawing::version() + ", its patch table at level " + std::to_string(osd_level) +
                " drawn on our GL context by its GLSL tessellation, triangle edges of about " +
                number(osd_edge_px, 0) + " px";
    osd.lacks = [](const cage &) { return std::string(); };
    osd.build = [](const cage &cage, const drawing &ours) {
        return std::make_unique<osd_peer>(cage, ours);
    };
    return has_gl ? std::vector<frame_peer_kind>{embree, osd}
                  : std::vector<frame_peer_kind>{embree};
}
