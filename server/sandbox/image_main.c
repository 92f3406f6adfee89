/* sheend-image: reads and writes images for sheend, each in a sandboxed process of its own. */
#include "server/image/image.h"
#include "server/sandbox/image_tasks.h"

int main(int argc, char **argv)
{
    image_use_one_thread(); /* a forked child has no other threads */
    return zygote_main(argc, argv, image_tasks);
}
