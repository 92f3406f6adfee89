/* Confines the daemon itself once it has started: it serves the sockets that it has, and can start
 * no program, open no other socket, write no file and signal no other process. README.md beside
 * this file lists what is left to it. */
#ifndef SHEEN_SANDBOX_CONFINE_H
#define SHEEN_SANDBOX_CONFINE_H

#include <stdbool.h>

/* What draws decides what the daemon may still do. */
enum confine_kind {
    CONFINE_COMPUTING, /* the daemon's own code on processors */
    /* A driver of a GPU, or Mesa's software device: it makes executable code and threads, keeps
     * shaders in files, and speaks to the kernel by ioctl(). */
    CONFINE_DRIVER,
};

/* Confines all threads of the process for ever, and those that they start. From now on a forbidden
 * call fails with EPERM and leaves a line in the kernel's log. False with errno if the kernel
 * refuses. */
bool confine_enter(enum confine_kind kind);

#endif
