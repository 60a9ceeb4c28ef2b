#include "bench/report/claims.hpp"

#include <array>
#include <fmt/format.h>
#include <string>

namespace irt {

nlohmann::ordered_json claims_for_report(const Claims& claims) {
  constexpr std::array orderings{"none", "FIFO per producer", "FIFO, relaxed",
                                 "FIFO by happens-before", "FIFO in real time"};
  constexpr std::array progresses{"blocking", "obstruction-free", "lock-free", "wait-free"};
  constexpr std::array reclamations{"at once",          "hazard pointers", "epochs",
                                    "free list",        "preallocated",    "at destruction",
                                    "the library's own"};
  const auto word = [](const auto& words, auto value) {
    return words.at(static_cast<std::size_t>(value));
  };
  std::string ordering = word(orderings, claims.ordering);
  if (claims.relaxation > 0) ordering += fmt::format(" by {}", claims.relaxation);
  return {{"ordering", ordering},
          {"push", word(progresses, claims.push)},
          {"pop", word(progresses, claims.pop)},
          {"bound", claims.bounded ? "bounded" : "unbounded"},
          {"reclamation", word(reclamations, claims.reclamation)}};
}

}  // namespace irt
