#include "tests/bench/bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <jansson.h>

namespace
{

struct json_deleter {
    void operator()(json_t *json) const
    {
        json_decref(json);
    }
};
using json_owner = std::unique_ptr<json_t, json_deleter>;

/* Takes the reference `value`. */
void put(const json_owner &object, const std::string &key, json_t *value)
{
    if (json_object_set_new(object.get(), key.c_str(), value))
        throw std::runtime_error(key + ": cannot be written as JSON");
}

/* The "figures" of an earlier run's file; empty if there is no such file. */
json_owner read_figures(const std::string &path)
{
    json_owner none(json_object());
    if (!std::filesystem::exists(path))
        return none;
    json_owner old(json_load_file(path.c_str(), 0, nullptr));
    json_t *figures = json_object_get(old.get(), "figures");
    if (!json_is_object(figures)) {
        std::printf("%s holds no figures to compare with\n", path.c_str());
        return none;
    }
    std::printf("against %s:\n", path.c_str());
    return json_owner(json_incref(figures));
}

int positive(const std::string &option, const std::string &value)
{
    char *end;
    long n = std::strtol(value.c_str(), &end, 10);
    if (*end || n < 1 || n > 1000000)
        throw std::invalid_argument(option + " " + value + " is no number from 1 to 1000000");
    return (int)n;
}

void add_those_there(const std::vector<std::string> &paths, std::vector<std::string> *found)
{
    for (const std::string &path : paths) {
        if (std::filesystem::exists(path))
            found->push_back(path);
        else
            std::printf("MISSING: %s is not there; going on without it\n", path.c_str());
    }
}

} // namespace

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

std::vector<turn> measure_in_turn(int runs, const std::vector<timed_call> &calls)
{
    std::vector<turn> turns(calls.size());
    for (int run = 0; run <= runs; run++) {
        double first = 0;
        for (size_t i = 0; i < calls.size(); i++) {
            double ms = calls[i](run);
            if (i == 0)
                first = ms;
            if (run == 0)
                continue;
            turns[i].ms.add(ms);
            turns[i].ratio.add(ms / first);
        }
    }
    return turns;
}

pair_of_samples measure_pairs(int runs, const timed_call &a, const timed_call &b)
{
    std::vector<turn> turns = measure_in_turn(runs, {a, b});
    return {turns[0].ms, turns[1].ms, turns[1].ratio};
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

options parse_options(const std::vector<std::string> &arguments,
                      const std::vector<std::string> &known)
{
    options options;
    for (size_t i = 0; i < arguments.size(); i++) {
        const std::string &word = arguments[i];
        if (word.rfind("--", 0) != 0) {
            options.words.push_back(word);
            continue;
        }
        std::string key = word.substr(2);
        if (++i == arguments.size())
            throw std::invalid_argument(word + " needs a value");
        const std::string &value = arguments[i];
        if (key == "runs")
            options.runs = positive(word, value);
        else if (key == "folder")
            options.folder = value;
        else if (key == "compare")
            options.compare = value;
        else if (std::count(known.begin(), known.end(), key))
            options.others.emplace_back(key, value);
        else
            throw std::invalid_argument("there is no option " + word + " here: --help lists them");
    }
    return options;
}

report::report(const std::string &report_name, const options &given)
    : name(report_name), asked(given)
{
    std::printf("--- %s ---\n", name.c_str());
}

void report::figure(const std::string &figure_name, double value)
{
    figures.emplace_back(figure_name, value);
}

void report::note(const std::string &key, const std::string &value)
{
    if (std::count(notes.begin(), notes.end(), std::make_pair(key, value)))
        return;
    notes.emplace_back(key, value);
    std::printf("%s: %s\n", key.c_str(), value.c_str());
}

void report::finish() const
{
    std::filesystem::path path = std::filesystem::path(asked.folder) / (name + ".json");
    json_owner old = read_figures(asked.compare.empty() ? path.string() : asked.compare);
    json_owner json(json_object()), now_figures(json_object()), before(json_object());
    char date[32];
    std::time_t now = std::time(nullptr);
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    put(json, "date", json_string(date));
    for (const auto &[key, value] : notes)
        put(json, key, json_string(value.c_str()));
    table table({"figure", "then", "now", "now/then"});
    for (const auto &[key, value] : figures) {
        put(now_figures, key, std::isfinite(value) ? json_real(value) : json_null());
        double then = json_number_value(json_object_get(old.get(), key.c_str()));
        if (then == 0)
            continue;
        put(before, key, json_real(then));
        table.row({key, number(then, 3), number(value, 3), number(value / then, 2)});
    }
    put(json, "figures", now_figures.release());
    if (json_object_size(before.get())) {
        table.print();
        put(json, "before", before.release());
    }
    std::filesystem::create_directories(asked.folder);
    if (json_dump_file(json.get(), path.c_str(), JSON_INDENT(1)))
        throw std::runtime_error(path.string() + ": cannot be written");
    std::printf("written: %s\n\n", path.c_str());
}

std::vector<std::string> bench_models(const options &options)
{
    std::vector<std::string> wanted = options.words, found;
    if (wanted.empty())
        wanted = {"../shared/shapes/catmark_car.obj", "tests/models/fender.obj",
                  "../shared/shapes/catmark_bishop.obj"};
    add_those_there(wanted, &found);
    if (found.size() < 2 && options.words.empty())
        add_those_there({"tests/models/body.obj", "tests/models/creases.obj"}, &found);
    if (found.empty())
        throw std::runtime_error("no model is there: name OBJ files of your own");
    return found;
}

std::string model_name(const std::string &path)
{
    return std::filesystem::path(path).stem().string();
}
