/* bench_size SHEEN: what a cage of N x N regular quads costs, from 10,000 to 1,000,000 faces: to
 * read, to build its tables in two threads, bytes a face, and its first frame through a daemon.
 * Cost must grow with the number of faces and no faster: the last column is time a face against the
 * first row's. */
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/oracle/render.h"

extern "C" {
#include "server/limit/tables.h"
}

namespace
{

const int n_threads = 2;

double now_ms()
{
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

/* A rolling sheet over [0,1] x [0,1]. */
void write_sheet(const std::string &path, int n)
{
    std::FILE *file = std::fopen(path.c_str(), "w");
    if (!file)
        throw std::runtime_error(path + ": cannot be written");
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++) {
            double x = (double)i / n, y = (double)j / n;
            std::fprintf(file, "v %.9g %.9g %.9g\n", x, y,
                         0.05 * std::sin(9 * x) * std::cos(7 * y));
        }
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            int a = j * (n + 1) + i + 1;
            std::fprintf(file, "f %d %d %d %d\n", a, a + 1, a + n + 2, a + n + 1);
        }
    std::fclose(file);
}

struct costs {
    double faces, import_ms, tables_ms, bytes, frame_ms;
};

void fail(bool ok, const error &error)
{
    if (!ok)
        throw std::runtime_error(error.text);
}

/* Equal ranges of faces to each thread. */
void build(limit_tables *tables, const limit_plan *plan)
{
    std::thread threads[n_threads];
    error errors[n_threads];
    bool built[n_threads];
    for (int k = 0; k < n_threads; k++)
        threads[k] = std::thread([&, k] {
            built[k] = limit_build_faces(tables, plan, tables->n_faces * (size_t)k / n_threads,
                                         tables->n_faces * (size_t)(k + 1) / n_threads, &errors[k]);
        });
    for (std::thread &thread : threads)
        thread.join();
    for (int k = 0; k < n_threads; k++)
        fail(built[k], errors[k]);
}

costs measure(const std::string &sheen, int n)
{
    temporary_folder folder;
    std::string path = folder.file("sheet.obj");
    write_sheet(path, n);
    std::ifstream file(path, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    error error;
    cage cage;
    limit_tables tables;
    double start = now_ms();
    fail(cage_read(&cage, bytes.data(), bytes.size(), path.c_str(), &error), error);
    double imported = now_ms();
    limit_plan *plan = limit_plan_create(&cage, &error);
    fail(plan, error);
    fail(limit_tables_init(&tables, plan, &error), error);
    build(&tables, plan);
    double built = now_ms();
    costs costs = {(double)n * n, imported - start, built - imported,
                   (double)limit_tables_bytes(&tables) / ((double)n * n), 0};
    limit_tables_finish(&tables);
    limit_plan_destroy(plan);
    cage_finish(&cage);
    bytes.clear();
    bytes.shrink_to_fit();

    start = now_ms();
    program_result result = run_program(
        {sheen, "render", path, "-o", folder.file("frame.png"), "--size", "1280x720"}, folder);
    if (result.exit_code != 0)
        throw std::runtime_error("sheen render: " + result.errors);
    costs.frame_ms = now_ms() - start;
    return costs;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "usage: bench_size SHEEN\n");
        return 2;
    }
    std::printf("%9s %10s %10s %8s %14s %s\n", "faces", "import ms", "tables ms", "B/face",
                "first frame ms", "time a face, import and tables, against the first row");
    costs first = {};
    try {
        for (int n : {100, 316, 1000}) {
            costs c = measure(argv[1], n);
            if (n == 100)
                first = c;
            std::printf("%9.0f %10.1f %10.1f %8.1f %14.0f %.2f %.2f\n", c.faces, c.import_ms,
                        c.tables_ms, c.bytes, c.frame_ms,
                        c.import_ms / c.faces / (first.import_ms / first.faces),
                        c.tables_ms / c.faces / (first.tables_ms / first.faces));
            std::fflush(stdout);
        }
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "bench_size: %s\n", failure.what());
        return 1;
    }
    return 0;
}
