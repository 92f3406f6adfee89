#include "server/sandbox/cage_tasks.h"

#include "server/cage/read/read.h"
#include "server/sandbox/cage_code.h"

static void read_cage(struct source *input, struct sink *answer)
{
    const char *name;
    size_t size;
    const void *file = job_take_file(input, &name, &size);
    struct error error = {0};
    struct cage cage = {0};
    if (!file)
        error_set(&error, ERROR_SERVER, "there is no file in this job");
    if (!file || !cage_read(&cage, file, size, name, &error)) {
        answer_write_error(answer, &error);
        return;
    }
    answer_write_ok(answer);
    cage_write(answer, &cage);
    cage_finish(&cage);
}

const struct zygote_task cage_tasks[N_JOB_KINDS] = {[JOB_READ_CAGE] = {read_cage}};
