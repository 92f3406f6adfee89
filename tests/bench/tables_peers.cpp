#include "tests/bench/peers.h"

#include "tests/bench/osd_patches.h"

std::vector<tables_peer> tables_peers()
{
    std::vector<tables_peer> peers;
    for (int level : {6, 10})
        peers.push_back({"OpenSubdiv level " + std::to_string(level),
                         [level](const cage &cage) { osd_patches patches(cage, level); }});
    return peers;
}
