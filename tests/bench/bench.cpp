#include "tests/bench/bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

double now_ms()
{
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

void samples::add(double value)
{
    sorted.insert(std::upper_bound(sorted.begin(), sorted.end(), value), value);
}

double samples::percentile(double p) const
{
    if (sorted.empty())
        throw std::logic_error("no sample was measured");
    double rank = std::ceil(p / 100 * (double)sorted.size());
    return sorted[(size_t)std::clamp(rank - 1, 0.0, (double)sorted.size() - 1)];
}

pair_of_samples measure_pairs(int runs, const timed_call &a, const timed_call &b)
{
    pair_of_samples pair;
    a(0), b(0);
    for (int run = 1; run <= runs; run++) {
        double ms_a = a(run), ms_b = b(run);
        pair.a.add(ms_a);
        pair.b.add(ms_b);
        pair.ratio.add(ms_b / ms_a);
    }
    return pair;
}

double time_ms(const std::function<void()> &call)
{
    double start = now_ms();
    call();
    return now_ms() - start;
}

table::table(std::vector<std::string> headings) : rows{std::move(headings)}
{
}

void table::row(std::vector<std::string> cells)
{
    rows.push_back(std::move(cells));
}

void table::print() const
{
    std::vector<size_t> width(rows[0].size());
    for (const auto &row : rows)
        for (size_t i = 0; i < width.size() && i < row.size(); i++)
            width[i] = std::max(width[i], row[i].size());
    for (const auto &row : rows) {
        for (size_t i = 0; i < row.size(); i++)
            std::printf(i ? "  %*s" : "%-*s", (int)width[i], row[i].c_str());
        std::printf("\n");
    }
    std::printf("\n");
    std::fflush(stdout);
}

std::string number(double value, int digits)
{
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

std::string count(double value)
{
    std::string text = number(value, 0);
    for (int at = (int)text.size() - 3; at > 0; at -= 3)
        text.insert((size_t)at, ",");
    return text;
}

std::string options::other(const std::string &key, const std::string &otherwise) const
{
    for (const auto &pair : others)
        if (pair.first == key)
            return pair.second;
    return otherwise;
}

report::report(const std::string &report_name, int argc, char **argv,
               std::vector<std::string> known)
    : name(report_name)
{
    for (int i = 1; i < argc; i++) {
        std::string word = argv[i];
        if (word.rfind("--", 0) != 0) {
            asked.words.push_back(word);
            continue;
        }
        std::string key = word.substr(2);
        if (++i == argc)
            throw std::invalid_argument(word + " needs a value");
        if (key == "runs")
            asked.runs = std::max(1, std::stoi(argv[i]));
        else if (key == "folder")
            asked.folder = argv[i];
        else if (key == "compare")
            asked.compare = argv[i];
        else if (std::count(known.begin(), known.end(), key))
            asked.others.emplace_back(key, argv[i]);
        else
            throw std::invalid_argument(word + " is no option of " + name);
    }
    std::printf("--- %s ---\n", name.c_str());
}

void report::figure(const std::string &figure_name, double value)
{
    figures.emplace_back(figure_name, value);
}

void report::note(const std::string &key, const std::string &value)
{
    notes.emplace_back(key, value);
    std::printf("%s: %s\n", key.c_str(), value.c_str());
}

void report::compare(const std::string &path) const
{
    std::ifstream file(path);
    if (!file)
        return;
    nlohmann::json old = nlohmann::json::parse(file, nullptr, false);
    if (!old.is_object() || !old.contains("figures")) {
        std::printf("%s holds no figures to compare with\n", path.c_str());
        return;
    }
    std::printf("against %s of %s:\n", path.c_str(), old.value("date", "?").c_str());
    table table({"figure", "then", "now", "now/then"});
    for (const auto &[key, value] : figures) {
        const nlohmann::json &figure = old["figures"][key];
        double then = figure.is_number() ? figure.get<double>() : 0;
        if (then != 0)
            table.row({key, number(then, 3), number(value, 3), number(value / then, 2)});
    }
    table.print();
}

void report::finish() const
{
    std::filesystem::path path = std::filesystem::path(asked.folder) / (name + ".json");
    compare(asked.compare.empty() ? path.string() : asked.compare);
    nlohmann::ordered_json json;
    char date[32];
    std::time_t now = std::time(nullptr);
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    json["date"] = date;
    for (const auto &[key, value] : notes)
        json[key] = value;
    for (const auto &[key, value] : figures)
        json["figures"][key] = value;
    std::filesystem::create_directories(asked.folder);
    std::ofstream file(path);
    file << json.dump(1) << "\n";
    if (!file.flush())
        throw std::runtime_error(path.string() + ": cannot be written");
    std::printf("written: %s\n\n", path.c_str());
}

std::vector<std::string> bench_models(const options &options)
{
    std::vector<std::string> wanted = options.words, found;
    if (wanted.empty())
        wanted = {"/work/shared/shapes/catmark_car.obj", "tests/models/fender.obj",
                  "/work/shared/shapes/catmark_bishop.obj"};
    for (const std::string &path : wanted) {
        if (std::filesystem::exists(path))
            found.push_back(path);
        else
            std::printf("MISSING: %s is not there; going on without it\n", path.c_str());
    }
    if (found.size() < 2 && options.words.empty()) {
        std::printf("MISSING: the shapes; tests/models/body.obj and creases.obj stand in\n");
        found.insert(found.end(), {"tests/models/body.obj", "tests/models/creases.obj"});
    }
    return found;
}

std::string model_name(const std::string &path)
{
    return std::filesystem::path(path).stem().string();
}

int bench_main(const char *name, const std::function<void()> &body)
{
    try {
        body();
        return 0;
    } catch (const std::invalid_argument &wrong) {
        std::fprintf(stderr, "%s: %s\n", name, wrong.what());
        return 2;
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "%s: %s\n", name, failure.what());
        return 1;
    }
}
