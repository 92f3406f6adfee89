/* main() of every benchmark: runs the questions that are linked in, one after the other. */
#include "tests/bench/question.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>

namespace
{

using questions = std::vector<const question *>;

/* Made when the first question registers, because objects at namespace scope are constructed in no
 * defined order. */
questions &linked()
{
    static questions all;
    return all;
}

bool alone()
{
    return linked().size() == 1;
}

/* The questions that the first word names, and removes that word; a program with one question runs
 * it. */
questions choose(std::vector<std::string> *arguments)
{
    if (alone())
        return linked();
    if (arguments->empty())
        throw std::invalid_argument("what shall be measured? --help lists it");
    std::string word = arguments->front();
    arguments->erase(arguments->begin());
    questions chosen;
    for (const question *question : linked())
        if (word == "all" || word == question->name)
            chosen.push_back(question);
    if (chosen.empty())
        throw std::invalid_argument("'" + word + "' is nothing to measure: --help lists what is");
    return chosen;
}

void help(const std::string &program)
{
    std::printf("usage: %s%s [--runs N] [--folder FOLDER] [--compare OLD.json] [--KEY VALUE]... "
                "[MODEL.obj]...\n\n",
                program.c_str(), alone() ? "" : " QUESTION|all");
    for (const question *question : linked()) {
        std::string keys;
        for (const std::string &key : question->keys)
            keys += " --" + key;
        std::printf("  %-8s %s\n           knows%s\n", question->name.c_str(),
                    question->asks.c_str(), keys.empty() ? " nothing else" : keys.c_str());
    }
    std::printf("\n  --runs     measured so often in turn (9), medians are printed\n"
                "  --folder   where the figures go, one JSON file a question (build/bench)\n"
                "  --compare  figures to set beside them (those that lie there)\n"
                "  --device   native, software, the number of an EGL device, or auto: hardware "
                "first (auto)\n");
}

void run(const std::string &program, std::vector<std::string> arguments)
{
    std::sort(linked().begin(), linked().end(),
              [](const question *a, const question *b) { return a->name < b->name; });
    if (std::count(arguments.begin(), arguments.end(), "--help"))
        return help(program);
    questions chosen = choose(&arguments);
    std::vector<std::string> known;
    for (const question *question : chosen)
        known.insert(known.end(), question->keys.begin(), question->keys.end());
    options given = parse_options(arguments, known);
    for (const question *question : chosen) {
        report report(alone() ? program : program + "_" + question->name, given);
        question->ask(&report);
        report.finish();
    }
}

} // namespace

question::question(const char *its_name, const char *its_asks, std::vector<std::string> its_keys,
                   std::function<void(report *report)> its_ask)
    : name(its_name), asks(its_asks), keys(std::move(its_keys)), ask(std::move(its_ask))
{
    linked().push_back(this);
}

int main(int argc, char **argv)
{
    std::string program = std::filesystem::path(argv[0]).filename();
    try {
        run(program, {argv + 1, argv + argc});
        return 0;
    } catch (const std::invalid_argument &wrong) {
        std::fprintf(stderr, "%s: %s\n", program.c_str(), wrong.what());
        return 2;
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "%s: %s\n", program.c_str(), failure.what());
        return 1;
    }
}
