/* A cage as libosd's refiner, from which its patches and its levels are made. */
#ifndef SHEEN_TESTS_ORACLE_OSD_REFINER_H
#define SHEEN_TESTS_ORACLE_OSD_REFINER_H

#include <memory>

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "tests/oracle/vec.h"

extern "C" {
#include "server/cage/cage.h"
}

/* A point with the interface of libosd's templates. */
struct control_point {
    vec3 p;
    void Clear(void * = nullptr)
    {
        p = vec3();
    }
    void AddWithWeight(const control_point &other, double weight)
    {
        p = p + weight * other.p;
    }
};

/* Throws std::runtime_error when the scheme is not Catmull-Clark or libosd refuses the cage. */
std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> make_refiner(const cage &cage);

#endif
