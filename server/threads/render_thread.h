/* The only thread that uses the renderer, and with it the GL context, as long as the daemon runs.
 * Tasks submitted here get the `struct renderer *` as their context and run in order; no other
 * thread calls a function with a renderer. A task that finds the device lost fails, and the
 * renderer opens the device again (renderer.h); the loop's thread sees the loss in
 * render_thread_losses().
 * Thread: the loop's, for all functions here. */
#ifndef SHEEN_THREADS_RENDER_THREAD_H
#define SHEEN_THREADS_RENDER_THREAD_H

#include "server/render/renderer.h"
#include "server/threads/task.h"

struct render_thread;

/* Starts the thread and opens the device on it; waits for that. NULL with the renderer's
 * ERROR_DEVICE. */
struct render_thread *render_thread_create(const struct renderer_device *device,
                                           const struct renderer_options *options,
                                           struct completions *completions, struct error *error);

/* Runs all submitted tasks to their end and closes the device. NULL is safe. */
void render_thread_destroy(struct render_thread *thread);

void render_thread_submit(struct render_thread *thread, struct task *task);

/* How often the device was lost, or could not be opened again. */
uint32_t render_thread_losses(const struct render_thread *thread);

/* How often frames that wait for the device's programs (FRAME_PROGRAMS) were told to continue. Any
 * thread; after each time the loop's hook runs. */
uint32_t render_thread_wakes(const struct render_thread *thread);

/* As pool_busy_us(). */
uint64_t render_thread_busy_us(const struct render_thread *thread, uint64_t now_us);

/* How long the device has been making one program; 0: it makes none. Any thread. */
uint64_t render_thread_compiling_us(const struct render_thread *thread, uint64_t now_us);

/* The device that the thread was created with. */
const struct renderer_device *render_thread_device(const struct render_thread *thread);

/* Does not change while the thread lives. */
const struct renderer_info *render_thread_info(const struct render_thread *thread);

#endif
