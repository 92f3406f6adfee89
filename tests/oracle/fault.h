/* Faults put in on purpose, so that self_test.sh can show that the oracles find them. */
#ifndef SHEEN_TESTS_ORACLE_FAULT_H
#define SHEEN_TESTS_ORACLE_FAULT_H

#include <cstdlib>
#include <string>

/* Whether the environment's FAKE_FAULTS (comma-separated) has this one. */
inline bool has_fault(const char *name)
{
    const char *faults = std::getenv("FAKE_FAULTS");
    if (!faults)
        return false;
    std::string list = std::string(",") + faults + ",";
    return list.find(std::string(",") + name + ",") != std::string::npos;
}

#endif
