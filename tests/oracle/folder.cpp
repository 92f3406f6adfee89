#include "tests/oracle/folder.h"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

temporary_folder::temporary_folder()
{
    const char *parent = std::getenv("TMPDIR");
    path = std::string(parent && *parent ? parent : "/tmp") + "/sheen-oracle-XXXXXX";
    if (!mkdtemp(path.data()))
        throw std::runtime_error("cannot make a temporary folder like " + path);
}

temporary_folder::~temporary_folder()
{
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
}
