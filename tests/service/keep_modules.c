/* Linked into a daemon with sanitizers: keeps drivers loaded until the end, so that the leak
 * checker finds the memory that their static variables point to. */
int dlclose(void *handle);

int dlclose(void *handle)
{
    (void)handle;
    return 0;
}
