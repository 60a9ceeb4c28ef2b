#include "bench/many_core/coherence/arbitration.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

namespace irt::many_core {
namespace {

struct Shares {
  std::vector<unsigned> served;  ///< by core
  unsigned longest = 0;          ///< services between two of the same core
  unsigned same_socket = 0;      ///< services of the socket that was served before
};

// 64 cores, the first ones in socket 0, ask for a line again whenever they have had it.
Shares compete(bool in_turn, unsigned in_first_socket, unsigned services) {
  constexpr unsigned cores = 64;
  Waiting waiting(2, in_turn);
  Random random(1);
  const auto socket = [&](unsigned core) { return core < in_first_socket ? 0U : 1U; };
  std::vector<Request> requests(cores);
  Shares shares{std::vector<unsigned>(cores)};
  std::vector<unsigned> since(cores);
  for (unsigned core = 0; core < cores; ++core) {
    requests[core].core = core;
    waiting.add(requests[core], socket(core), 0);
  }
  unsigned last = 0;
  for (Time now = 0; now < services; ++now) {
    Request& request = waiting.take(now, socket(last), 2, random);
    for (unsigned& each : since) ++each;
    shares.longest = std::max(shares.longest, since[request.core]);
    since[request.core] = 0;
    ++shares.served[request.core];
    shares.same_socket += socket(request.core) == socket(last) ? 1 : 0;
    last = request.core;
    request.arrival = now;
    waiting.add(request, socket(request.core), now);
  }
  return shares;
}

TEST(Arbitration, cores_of_two_sockets_get_alike) {
  const Shares shares = compete(true, 32, 64'000);
  // As often as each other, never more than two rounds apart, and most hand-overs are short.
  EXPECT_LE(std::ranges::max(shares.served) - std::ranges::min(shares.served), 1U);
  EXPECT_LT(shares.longest, 2 * 64U);
  EXPECT_GT(shares.same_socket, 64'000 * 6 / 10);
}

// Neither are the fewer cores of a socket left behind by the many of the other.
TEST(Arbitration, cores_of_two_sockets_get_alike_where_any_may_be_next) {
  for (const unsigned in_first_socket : {32U, 48U}) {
    const Shares shares = compete(false, in_first_socket, 640'000);
    EXPECT_GT(std::ranges::min(shares.served), 9'500U) << in_first_socket;
    EXPECT_LT(std::ranges::max(shares.served), 10'500U) << in_first_socket;
    EXPECT_GT(shares.same_socket, 640'000 * 6 / 10) << in_first_socket;
  }
}

}  // namespace
}  // namespace irt::many_core
