#ifndef SHEEN_TESTS_ORACLE_FOLDER_H
#define SHEEN_TESTS_ORACLE_FOLDER_H

#include <string>

/* A temporary folder under TMPDIR, removed with its contents at the end. */
class temporary_folder
{
  public:
    temporary_folder();
    ~temporary_folder();
    temporary_folder(const temporary_folder &) = delete;
    temporary_folder &operator=(const temporary_folder &) = delete;
    std::string file(const std::string &name) const
    {
        return path + "/" + name;
    }

  private:
    std::string path;
};

#endif
