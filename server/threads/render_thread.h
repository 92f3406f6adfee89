/* The one thread that owns the renderer, and with it the GL context, for the daemon's life.
 * Tasks submitted here get the `struct renderer *` as their context and run in order; nobody else
 * calls renderer_*() with a renderer. The thread opens a lost device again (renderer.h); the task
 * that fails tells the loop's thread of the loss. Thread: the functions here are for the loop's
 * thread. */
#ifndef SHEEN_THREADS_RENDER_THREAD_H
#define SHEEN_THREADS_RENDER_THREAD_H

#include "server/render/renderer.h"
#include "server/threads/task.h"

struct render_thread;

/* Opens the device on the new thread and waits for it. NULL with the renderer's ERROR_DEVICE. */
struct render_thread *render_thread_create(const struct renderer_device *device,
                                           const struct renderer_options *options,
                                           struct completions *completions, struct error *error);

/* Finishes every submitted task and closes the device. NULL is safe. */
void render_thread_destroy(struct render_thread *thread);

void render_thread_submit(struct render_thread *thread, struct task *task);

/* How often the device has been lost, or could not be opened again. */
uint32_t render_thread_losses(const struct render_thread *thread);

/* As pool_busy_us(). */
uint64_t render_thread_busy_us(const struct render_thread *thread, uint64_t now_us);

/* As it was created with. */
const struct renderer_device *render_thread_device(const struct render_thread *thread);

/* Constant while the thread lives. */
const struct renderer_info *render_thread_info(const struct render_thread *thread);

#endif
