#include "bench/conditions/claims.hpp"

#include <array>
#include <string>

namespace irt {
namespace {

std::string words(const Claims& claims, Ordering ordering) {
  switch (ordering) {
    case Ordering::unordered:
      return "none";
    case Ordering::per_producer_fifo:
      return "FIFO per producer";
    case Ordering::k_relaxed_fifo:
      return "FIFO, relaxed by " + std::to_string(claims.relaxation);
    case Ordering::fifo_happens_before:
      return "FIFO by happens-before";
    case Ordering::fifo_real_time:
      return "FIFO in real time";
  }
  return {};
}

const char* words(Progress progress) {
  constexpr std::array names{"blocking", "obstruction-free", "lock-free", "wait-free"};
  return names.at(static_cast<std::size_t>(progress));
}

const char* words(Reclamation reclamation) {
  constexpr std::array names{
      "at once",        "hazard pointers",   "epochs",           "free list",   "preallocated",
      "at destruction", "the library's own", "quiescent states", "hazard eras", "last reader"};
  return names.at(static_cast<std::size_t>(reclamation));
}

}  // namespace

nlohmann::ordered_json claims_in_words(const Claims& claims) {
  return {{"ordering", words(claims, claims.ordering)},
          {"push", words(claims.push)},
          {"pop", words(claims.pop)},
          {"bound", claims.bounded ? "bounded" : "unbounded"},
          {"reclamation", words(claims.reclamation)}};
}

}  // namespace irt
