/* Linked into a daemon that is built with sanitizers: drivers stay loaded until the end, so that
 * the leak checker finds what their static variables point to. */
int dlclose(void *handle);

int dlclose(void *handle)
{
    (void)handle;
    return 0;
}
