/* Runs a fuzz target over the files of folders, without libFuzzer: replay FOLDER... */
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/fuzz/fuzz.h"

#define MAX_INPUT_BYTES (1 << 20)

static bool replay_file(const char *path)
{
    static uint8_t bytes[MAX_INPUT_BYTES];
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        return false;
    }
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    LLVMFuzzerTestOneInput(bytes, size);
    return true;
}

/* Returns the number of files, or -1 on failure. */
static int replay_folder(const char *folder)
{
    int n = 0;
    char path[PATH_MAX];
    DIR *entries = opendir(folder);
    if (!entries) {
        perror(folder);
        return -1;
    }
    for (const struct dirent *entry; n >= 0 && (entry = readdir(entries));) {
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        n = replay_file(path) ? n + 1 : -1;
    }
    closedir(entries);
    return n;
}

int main(int argc, char **argv)
{
    int sum = 0;
    for (int i = 1; i < argc; i++) {
        int n = replay_folder(argv[i]);
        if (n < 0)
            return 1;
        sum += n;
    }
    printf("%d passed, 0 failed\n", sum);
    return 0;
}
