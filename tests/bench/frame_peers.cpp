#include "tests/bench/peers.h"

#include "tests/bench/bench.h"
#include "tests/bench/embree.h"

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

} // namespace

std::vector<frame_peer_kind> frame_peers()
{
    frame_peer_kind embree;
    embree.name = "Embree";
    embree.about = embree_scene::version() + ", tessellation rate 4, " +
                   std::to_string(bench_threads) + " threads";
    embree.lacks = embree_lacks;
    embree.build = [](const cage &cage, const drawing &) {
        return std::make_unique<embree_peer>(cage);
    };
    return {embree};
}
