// Lists that one pass makes for another. Each is a buffer that begins with the arguments of the other pass's
// dispatch.

#define LIST(index, block, name)                                                                   \
    layout(std430, binding = index) buffer block { uint x, y, z, n, at[]; } name

const uint ROW = 32768u;  // workgroups in a row: a dispatch allows at most 65,535 in one dimension

// Adds pixel p, as x | y << 16, to a list whose pass takes per_group entries per workgroup.
#define LIST_ADD(list, p, per_group)                                                               \
    {                                                                                              \
        uint slot = atomicAdd(list.n, 1u);                                                         \
        if (slot % per_group == 0u) {                                                              \
            atomicMax(list.x, min(slot / per_group + 1u, ROW));                                    \
            atomicMax(list.y, slot / per_group / ROW + 1u);                                        \
        }                                                                                          \
        list.at[slot] = uint((p).x) | uint((p).y) << 16;                                           \
    }

ivec2 list_place(uint added)
{
    return ivec2(added & 0xffffu, added >> 16);
}
