#include "tests/bench/peers.h"

std::vector<frame_peer_kind> frame_peers(bool)
{
    return {};
}

std::vector<tables_peer> tables_peers()
{
    return {};
}
