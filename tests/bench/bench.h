/* What every benchmark shares: the clock, medians, tables, and figures kept from run to run.
 *
 * A question (question.h) gets a `report`, prints tables and names its figures. They go to
 * FOLDER/NAME.json, and those of the file that lay there before (or of --compare) are set beside
 * them. Figures are numbers where less is better unless their name ends in "ratio" or "per_s" or
 * "pixels" or "faces". */
#ifndef SHEEN_TESTS_BENCH_BENCH_H
#define SHEEN_TESTS_BENCH_BENCH_H

#include <functional>
#include <string>
#include <utility>
#include <vector>

double now_ms();

/* Measurements of one thing. */
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

/* Two things measured in turn, so that what else the machine does falls on both. */
struct pair_of_samples {
    samples a, b;
    samples ratio; /* b / a of each pair */
};
/* Each call returns its own milliseconds; `run` counts from 0. One unmeasured pair goes first. */
using timed_call = std::function<double(int run)>;
/* The same for any number of things; each has its ratio to the first of its own round. */
struct turn {
    samples ms, ratio;
};
std::vector<turn> measure_in_turn(int runs, const std::vector<timed_call> &calls);
pair_of_samples measure_pairs(int runs, const timed_call &a, const timed_call &b);
/* The milliseconds that a call takes. */
double time_ms(const std::function<void()> &call);

/* Rows of text under headings, as wide as they need: the first column to the left. */
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

    /* The value of --key, else what is given. */
    std::string other(const std::string &key, const std::string &otherwise) const;
    /* Of renderer_options. */
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
    /* Says, once, something about where the figures come from; goes to the file, too. */
    void note(const std::string &key, const std::string &value);
    /* Prints the comparison and writes the file, with the figures that it compared with. */
    void finish() const;

  private:
    std::string name;
    options asked;
    std::vector<std::pair<std::string, double>> figures;
    std::vector<std::pair<std::string, std::string>> notes;
};

/* The model files that a question measures: those asked for, else the car and the bishop of the
 * shapes and the fender. Those that are not there are named, and left out; without any shape the
 * models of tests/models stand in. Throws std::runtime_error when none is left. */
std::vector<std::string> bench_models(const options &options);
/* "catmark_car" of its path. */
std::string model_name(const std::string &path);

#endif
