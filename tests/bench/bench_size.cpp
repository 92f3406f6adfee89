/* bench_size [--faces MOST]: the costs of a cage of N x N regular quads, from 1,000 to 1,000,000
 * faces: the time to read it and to build its tables with two threads, the bytes for each face, and
 * the time of a frame of 1280x720 that shows all of it from a fixed view. Reading and building must
 * grow with the number of faces and no faster, a frame much more slowly. The last columns are
 * relative to the first row. */
#include "tests/bench/question.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "tests/oracle/scene.h"
#include "tests/bench/sheet.h"
#include "tests/bench/timing.h"
#include "tests/oracle/cage_file.h"
#include "tests/oracle/folder.h"

namespace
{

struct costs {
    double faces, import_ms, tables_ms, bytes, first_ms, frame_ms, wall_ms;
};

costs measure(report *report, const char *device, int n)
{
    temporary_folder folder;
    std::string path = folder.file("sheet.obj");
    sheet(n, n, 0).write_obj(path);
    costs costs = {};
    costs.faces = (double)n * n;
    std::shared_ptr<const cage> cage;
    std::unique_ptr<scene> tables;
    costs.import_ms = time_ms([&] { cage = read_cage_file(path); });
    costs.tables_ms = time_ms([&] { tables.reset(new scene(cage)); });
    costs.bytes = (double)tables->bytes() / costs.faces;
    drawing drawing(*tables, device);
    frame_request request = tables->request(1280, 720);
    note_device(report, drawing.info());
    costs.first_ms = drawing.cost(request).all_ms;
    samples frames, walls;
    for (int run = 0; run < report->given().runs; run++) {
        orbit(&request.camera, 0.1);
        frame_cost cost = drawing.cost(request);
        frames.add(cost.stages_ms());
        walls.add(cost.wall_ms);
    }
    costs.frame_ms = frames.median();
    costs.wall_ms = walls.median();
    return costs;
}

void ask(report *report)
{
    std::string device = report->given().device();
    table table({"faces", "import ms", "tables ms", "B/face", "first frame ms", "frame ms",
                 "wall ms", "import a face", "tables a face", "frame"});
    costs first = {};
    double most = std::stod(report->given().other("faces", "1e6"));
    for (int n : {32, 100, 316, 1000}) {
        if (n > 32 && (double)n * n > most)
            break;
        costs c = measure(report, device.c_str(), n);
        if (n == 32)
            first = c;
        double faces = c.faces / first.faces;
        table.row({count(c.faces), number(c.import_ms, 1), number(c.tables_ms, 1),
                   number(c.bytes, 1), number(c.first_ms, 0), number(c.frame_ms, 1),
                   number(c.wall_ms, 1), number(c.import_ms / first.import_ms / faces, 2),
                   number(c.tables_ms / first.tables_ms / faces, 2),
                   number(c.frame_ms / first.frame_ms, 1)});
        std::string key = number(c.faces, 0) + " faces ";
        report->figure(key + "import_ms", c.import_ms);
        report->figure(key + "tables_ms", c.tables_ms);
        report->figure(key + "bytes_a_face", c.bytes);
        report->figure(key + "frame_ms", c.frame_ms);
        report->figure(key + "wall_ms", c.wall_ms);
        report->figure(key + "frame/first", c.frame_ms / first.frame_ms);
    }
    table.print();
}

const question size("size", "faces from 10^3 to 10^6, or to --faces: reading, tables, a frame",
                    {"device", "faces"}, ask);

} // namespace
