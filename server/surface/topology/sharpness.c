#include "server/surface/topology/sharpness.h"

float sharpness_child(float sharpness)
{
    return sharpness_is_infinite(sharpness) ? sharpness : sharpness > 1 ? sharpness - 1 : 0;
}

void sharpness_add(struct sharpness_sum *sum, float sharpness)
{
    sum->sum += sharpness_is_semisharp(sharpness) ? sharpness : 0;
    sum->n += sharpness_is_semisharp(sharpness);
}

float sharpness_child_chaikin(float sharpness, const struct sharpness_sum *sum)
{
    if (sharpness_is_semisharp(sharpness) && sum->n > 1) {
        float others = (sum->sum - sharpness) / (float)(sum->n - 1);
        sharpness = 0.75f * sharpness + 0.25f * others;
    }
    return sharpness_child(sharpness);
}

double sharpness_crease_weight(float sharpness, float child, float far)
{
    if (sharpness <= 0)
        return 0;
    return sharpness_is_infinite(sharpness) || (child > 0 && far > 0) ? 1 : sharpness;
}
