/* Deliberate faults, by which self_test.sh shows that the oracles find them. */
#ifndef SHEEN_TESTS_ORACLE_FAULT_H
#define SHEEN_TESTS_ORACLE_FAULT_H

#include <cstdlib>
#include <string>

/* True if FAKE_FAULTS in the environment (comma-separated) has this name. */
inline bool has_fault(const char *name)
{
    const char *faults = std::getenv("FAKE_FAULTS");
    if (!faults)
        return false;
    std::string list = std::string(",") + faults + ",";
    return list.find(std::string(",") + name + ",") != std::string::npos;
}

#endif
