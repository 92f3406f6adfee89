/* What benchmarks share: the clock, medians, tables, and figures that are kept between runs. A
 * question (question.h) gets a `report`, prints tables and names its figures. They are written to
 * FOLDER/NAME.json, and compared with those of the earlier file there (or of --compare). For
 * figures less is better, unless their name ends in "ratio", "per_s", "pixels" or "faces". */
#ifndef SHEEN_TESTS_BENCH_BENCH_H
#define SHEEN_TESTS_BENCH_BENCH_H

#include <functional>
#include <string>
#include <utility>
#include <vector>

double now_ms();

/* The measurements of one thing. */
class samples
{
  public:
    void add(double value);
    double median() const
    {
        return percentile(50);
    }
    double least() const
    {
        return percentile(0);
    }
    /* 0 to 100, by nearest rank. */
    double percentile(double p) const;
    bool empty() const
    {
        return sorted.empty();
    }

  private:
    std::vector<double> sorted;
};

/* Two things measured alternately, so that other load on the machine affects both. */
struct pair_of_samples {
    samples a, b;
    samples ratio; /* b / a for each pair */
};
/* Each call returns its milliseconds; `run` counts from 0. One pair is run first without
 * measuring. */
using timed_call = std::function<double(int run)>;
/* As pair_of_samples for any number of things; each has its ratio to the first one in its round. */
struct turn {
    samples ms, ratio;
};
std::vector<turn> measure_in_turn(int runs, const std::vector<timed_call> &calls);
pair_of_samples measure_pairs(int runs, const timed_call &a, const timed_call &b);
/* Measures a call, in milliseconds. */
double time_ms(const std::function<void()> &call);

/* A table with headings and columns as wide as needed; the first column is left-aligned. */
class table
{
  public:
    explicit table(std::vector<std::string> headings);
    void row(std::vector<std::string> cells);
    void print() const;

  private:
    std::vector<std::vector<std::string>> rows;
};

std::string number(double value, int digits);
/* "1,575" */
std::string count(double value);

struct options {
    int runs = 9;
    std::string folder = "build/bench", compare;
    std::vector<std::string> words;
    std::vector<std::pair<std::string, std::string>> others; /* --key VALUE of the question's own */

    /* The value of --key, or the given default. */
    std::string other(const std::string &key, const std::string &otherwise) const;
    /* As in renderer_options. */
    std::string device() const
    {
        return other("device", "auto");
    }
};

/* [--runs N] [--folder FOLDER] [--compare OLD.json] [--key VALUE]... [word]...; `known` are the
 * --keys. Throws std::invalid_argument for a wrong option. */
options parse_options(const std::vector<std::string> &arguments,
                      const std::vector<std::string> &known);

class report
{
  public:
    report(const std::string &name, const options &given);
    const options &given() const
    {
        return asked;
    }
    void figure(const std::string &name, double value);
    /* Adds a note about the origin of the figures, printed once and written to the file. */
    void note(const std::string &key, const std::string &value);
    /* Prints the comparison and writes the file, with the figures that were compared. */
    void finish() const;

  private:
    std::string name;
    options asked;
    std::vector<std::pair<std::string, double>> figures;
    std::vector<std::pair<std::string, std::string>> notes;
};

/* The model files that a question measures: those named, else the car and the bishop of the shared
 * shapes, and the fender. Missing ones are named and left out; without any shared shape, the models
 * of tests/models are used. Throws std::runtime_error if none is left. */
std::vector<std::string> bench_models(const options &options);
/* The model's name from its path: "catmark_car". */
std::string model_name(const std::string &path);

#endif
