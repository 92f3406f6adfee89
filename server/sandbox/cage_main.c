/* sheend-cage: reads cages for sheend, each in a sandboxed process of its own. */
#include "server/sandbox/cage_tasks.h"

int main(int argc, char **argv)
{
    return zygote_main(argc, argv, cage_tasks);
}
