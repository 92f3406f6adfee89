#include "tests/bench/osd_patches.h"

#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/stencilTable.h>

namespace Far = OpenSubdiv::Far;

osd_patches::osd_patches(const cage &cage, int level)
{
    auto refiner = make_refiner(cage);
    Far::PatchTableFactory::Options options((unsigned)level);
    options.useInfSharpPatch = true;
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    table.reset(Far::PatchTableFactory::Create(*refiner, options));
    points.resize((size_t)refiner->GetNumVerticesTotal() + (size_t)table->GetNumLocalPoints());
    for (size_t i = 0; i < cage.n_vertices; i++)
        points[i].p = {cage.position[i][0], cage.position[i][1], cage.position[i][2]};
    Far::PrimvarRefiner primvar(*refiner);
    control_point *source = points.data();
    for (int k = 1; k < refiner->GetNumLevels(); k++) {
        control_point *target = source + refiner->GetLevel(k - 1).GetNumVertices();
        primvar.Interpolate(k, source, target);
        source = target;
    }
    if (table->GetNumLocalPoints() > 0)
        table->GetLocalPointStencilTable()->UpdateValues(
            points.data(), points.data() + refiner->GetNumVerticesTotal());
}
