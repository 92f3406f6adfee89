#include "tests/bench/embree.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <thread>

#include <embree3/rtcore.h>
#include <immintrin.h>

namespace
{

const int packet_width = 4, packet_height = 2, packet = packet_width * packet_height;
const uint32_t tile_rows = 8; /* of the picture, which a thread takes at a time */

struct float3 {
    float x, y, z;
};
inline float3 operator+(float3 a, float3 b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline float3 operator-(float3 a, float3 b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline float3 operator*(float k, float3 a)
{
    return {k * a.x, k * a.y, k * a.z};
}
inline float dot(float3 a, float3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float3 cross(float3 a, float3 b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float3 unit(float3 a)
{
    return 1 / std::sqrt(dot(a, a)) * a;
}
float3 from(const double a[3])
{
    return {(float)a[0], (float)a[1], (float)a[2]};
}

/* The camera as vectors: `corner` to the picture's top left, `across` and `down` for one pixel. */
struct pinhole {
    float3 eye, corner, across, down;

    explicit pinhole(const frame_request &request)
    {
        const camera &camera = request.camera;
        if (camera.kind != CAMERA_PERSPECTIVE)
            throw std::runtime_error("the Embree peer draws perspective cameras only");
        eye = from(camera.eye);
        float3 forward = unit(from(camera.target) - eye);
        float3 right = unit(cross(forward, from(camera.up))), up = cross(right, forward);
        float pixel =
            2 * std::tan((float)camera.fov_deg * (float)M_PI / 360) / (float)request.height_px;
        across = pixel * right;
        down = -pixel * up;
        corner = forward + (-0.5f * (float)request.width_px) * across +
                 (-0.5f * (float)request.height_px) * down;
    }
    float3 ray(uint32_t x, uint32_t y) const /* not of unit length */
    {
        return corner + ((float)x + 0.5f) * across + ((float)y + 0.5f) * down;
    }
};

/* The rectangle's stripes, and the colours of pixels that show none. */
struct striped_light {
    float3 centre, normal, u, v; /* u and v divided by their squared lengths */
    float count, duty;
    uint32_t foreground, background, miss, empty;

    explicit striped_light(const frame_request &request)
    {
        const light &light = request.lights[0];
        if (light.kind != LIGHT_RECTANGLE || light.pattern.kind != PATTERN_STRIPES)
            throw std::runtime_error("the Embree peer knows stripes on a rectangle only");
        centre = from(light.centre);
        u = from(light.u);
        v = from(light.v);
        normal = cross(u, v);
        u = 1 / dot(u, u) * u;
        v = 1 / dot(v, v) * v;
        count = (float)light.pattern.count;
        duty = (float)light.pattern.duty;
        foreground = rgba8(light.pattern.foreground);
        background = rgba8(light.pattern.background);
        miss = rgba8(request.miss);
        empty = rgba8(request.empty);
    }
    static uint32_t rgba8(const float colour[4])
    {
        uint32_t packed = 0;
        for (int i = 0; i < 4; i++)
            packed |= (uint32_t)std::lround(255 * colour[i]) << 8 * i;
        return packed;
    }
    /* The colour of the point x with unit normal n, seen along `view`. */
    uint32_t colour(float3 x, float3 n, float3 view) const
    {
        float3 r = view - (2 * dot(view, n)) * n;
        float t = dot(centre - x, normal) / dot(r, normal);
        float3 y = x + t * r - centre;
        float a = 0.5f + dot(y, u), b = 0.5f + dot(y, v);
        if (!(t > 0 && a >= 0 && a <= 1 && b >= 0 && b <= 1))
            return miss;
        float place = a * count;
        return place - std::floor(place) < duty ? foreground : background;
    }
};

template <class T>
T *new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t n,
              size_t stride = sizeof(T))
{
    return (T *)rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, n);
}

float sharpness_of(float sharpness)
{
    return sharpness >= CAGE_SHARPNESS_INFINITE ? std::numeric_limits<float>::infinity()
                                                : sharpness;
}

void set_topology(RTCGeometry geometry, const cage &cage)
{
    /* Embree reads vertices as four floats, so the last one needs a float behind it. */
    typedef float padded[4];
    padded *vertex =
        new_buffer<padded>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, cage.n_vertices);
    for (size_t i = 0; i < cage.n_vertices; i++)
        for (int k = 0; k < 4; k++)
            vertex[i][k] = k < 3 ? (float)cage.position[i][k] : 0;
    uint32_t *face =
        new_buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_FACE, RTC_FORMAT_UINT, cage.n_faces);
    for (size_t f = 0; f < cage.n_faces; f++)
        face[f] = cage.face_start[f + 1] - cage.face_start[f];
    size_t corners = cage.face_start[cage.n_faces];
    std::memcpy(new_buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, corners),
                cage.face_vertex, corners * sizeof(uint32_t));
    static const RTCSubdivisionMode modes[] = {RTC_SUBDIVISION_MODE_SMOOTH_BOUNDARY,
                                               RTC_SUBDIVISION_MODE_PIN_CORNERS,
                                               RTC_SUBDIVISION_MODE_NO_BOUNDARY};
    rtcSetGeometrySubdivisionMode(geometry, 0, modes[cage.boundary]);
}

void set_tags(RTCGeometry geometry, const cage &cage)
{
    if (cage.n_creases) {
        uint32_t *ends =
            new_buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_EDGE_CREASE_INDEX, RTC_FORMAT_UINT2,
                                 cage.n_creases, 2 * sizeof(uint32_t));
        float *weight = new_buffer<float>(geometry, RTC_BUFFER_TYPE_EDGE_CREASE_WEIGHT,
                                          RTC_FORMAT_FLOAT, cage.n_creases);
        for (size_t i = 0; i < cage.n_creases; i++) {
            ends[2 * i] = cage.crease[i].vertex[0];
            ends[2 * i + 1] = cage.crease[i].vertex[1];
            weight[i] = sharpness_of(cage.crease[i].sharpness);
        }
    }
    if (cage.n_corners) {
        uint32_t *vertex = new_buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_VERTEX_CREASE_INDEX,
                                                RTC_FORMAT_UINT, cage.n_corners);
        float *weight = new_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX_CREASE_WEIGHT,
                                          RTC_FORMAT_FLOAT, cage.n_corners);
        for (size_t i = 0; i < cage.n_corners; i++) {
            vertex[i] = cage.corner[i].vertex;
            weight[i] = sharpness_of(cage.corner[i].sharpness);
        }
    }
    if (cage.n_holes)
        std::memcpy(
            new_buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_HOLE, RTC_FORMAT_UINT, cage.n_holes),
            cage.hole, cage.n_holes * sizeof(uint32_t));
}

} // namespace

struct embree_scene::implementation {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    RTCGeometry geometry = nullptr;
    int n_threads;

    /* The work on one frame, which its threads share. */
    struct picture_job {
        const pinhole camera;
        const striped_light light;
        uint32_t width, height;
        embree_picture *picture;
        bool want_normals;
        std::atomic<uint32_t> next_row{0};
    };
    void trace(picture_job *job, uint32_t x, uint32_t y) const;
    void show(picture_job *job, const RTCRayHit8 &hit, int lane, size_t pixel) const;
    void work(picture_job *job) const;
};

/* The results for one pixel whose ray was traced. */
void embree_scene::implementation::show(picture_job *job, const RTCRayHit8 &hit, int lane,
                                        size_t pixel) const
{
    uint32_t colour = job->light.empty;
    float3 n = {NAN, NAN, NAN};
    if (hit.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) {
        alignas(16) float p[4], du[4], dv[4];
        rtcInterpolate1(geometry, hit.hit.primID[lane], hit.hit.u[lane], hit.hit.v[lane],
                        RTC_BUFFER_TYPE_VERTEX, 0, p, du, dv, 3);
        n = unit(cross({du[0], du[1], du[2]}, {dv[0], dv[1], dv[2]}));
        float3 x = {p[0], p[1], p[2]};
        colour = job->light.colour(x, n, unit(x - job->camera.eye));
    }
    std::memcpy(&job->picture->rgba[4 * pixel], &colour, 4);
    if (job->want_normals)
        std::memcpy(&job->picture->normals[3 * pixel], &n, sizeof n);
}

void embree_scene::implementation::trace(picture_job *job, uint32_t x, uint32_t y) const
{
    RTCRayHit8 ray;
    alignas(32) int valid[packet];
    for (int i = 0; i < packet; i++) {
        uint32_t px = x + (uint32_t)i % packet_width, py = y + (uint32_t)i / packet_width;
        valid[i] = px < job->width && py < job->height ? -1 : 0;
        float3 d = job->camera.ray(px, py);
        ray.ray.org_x[i] = job->camera.eye.x;
        ray.ray.org_y[i] = job->camera.eye.y;
        ray.ray.org_z[i] = job->camera.eye.z;
        ray.ray.dir_x[i] = d.x;
        ray.ray.dir_y[i] = d.y;
        ray.ray.dir_z[i] = d.z;
        ray.ray.tnear[i] = 0;
        ray.ray.tfar[i] = std::numeric_limits<float>::infinity();
        ray.ray.time[i] = 0;
        ray.ray.mask[i] = ~0u;
        ray.ray.flags[i] = 0;
        ray.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &ray);
    for (int i = 0; i < packet; i++) {
        uint32_t px = x + (uint32_t)i % packet_width, py = y + (uint32_t)i / packet_width;
        if (valid[i])
            show(job, ray, i, (size_t)py * job->width + px);
    }
}

void embree_scene::implementation::work(picture_job *job) const
{
    /* As Embree's manual demands. */
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _mm_setcsr(_mm_getcsr() | 0x40); /* denormals are zero */
    for (uint32_t row; (row = job->next_row.fetch_add(tile_rows)) < job->height;)
        for (uint32_t y = row; y < row + tile_rows; y += packet_height)
            for (uint32_t x = 0; x < job->width; x += packet_width)
                trace(job, x, y);
}

embree_scene::embree_scene(const cage &cage, unsigned rate, int n_threads) : m(new implementation)
{
    m->n_threads = n_threads;
    m->device = rtcNewDevice(("threads=" + std::to_string(n_threads)).c_str());
    if (!m->device)
        throw std::runtime_error("Embree opens no device");
    m->geometry = rtcNewGeometry(m->device, RTC_GEOMETRY_TYPE_SUBDIVISION);
    set_topology(m->geometry, cage);
    set_tags(m->geometry, cage);
    rtcSetGeometryTessellationRate(m->geometry, (float)rate);
    rtcCommitGeometry(m->geometry);
    m->scene = rtcNewScene(m->device);
    rtcAttachGeometry(m->scene, m->geometry);
    rtcCommitScene(m->scene);
    RTCError wrong = rtcGetDeviceError(m->device);
    if (wrong != RTC_ERROR_NONE)
        throw std::runtime_error("Embree's error " + std::to_string(wrong));
}

embree_scene::~embree_scene()
{
    rtcReleaseScene(m->scene);
    rtcReleaseGeometry(m->geometry);
    rtcReleaseDevice(m->device);
}

void embree_scene::render(const frame_request &request, bool want_normals,
                          embree_picture *picture) const
{
    size_t pixels = (size_t)request.width_px * request.height_px;
    picture->rgba.resize(4 * pixels);
    picture->normals.resize(want_normals ? 3 * pixels : 0);
    implementation::picture_job job = {pinhole(request), striped_light(request),
                                       request.width_px, request.height_px,
                                       picture,          want_normals};
    std::vector<std::thread> others;
    for (int k = 1; k < m->n_threads; k++)
        others.emplace_back([&] { m->work(&job); });
    std::thread([&] { m->work(&job); }).join(); /* the rounding modes that it set end with it */
    for (std::thread &thread : others)
        thread.join();
}

std::string embree_scene::version()
{
    return "Embree " RTC_VERSION_STRING;
}

std::string embree_lacks(const cage &cage)
{
    std::string lacks;
    if (cage.chaikin)
        lacks += " chaikin";
    if (cage.smooth_triangles)
        lacks += " smoothtriangles";
    return lacks;
}
