/// How far the order in which elements leave a queue strays from that of their pushes, measured of
/// a log of all operations.
#pragma once

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "bench/results/record.hpp"
#include "stress/history/real_time.hpp"

namespace irt::results {

/// Of one run; see stress::Relaxation.
struct OrderOfElements {
  std::uint64_t operations = 0;  ///< that were logged
  double rank_error_mean = 0;    ///< elements, as the next two
  std::uint64_t rank_error_p99 = 0, rank_error_max = 0;
  double pushes_overtaken = 0, pops_overtaken = 0;  ///< shares of 1
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OrderOfElements, operations, rank_error_mean, rank_error_p99,
                                   rank_error_max, pushes_overtaken, pops_overtaken)

/// The order of the operations in `logs`, as stress::distinct wants them.
inline OrderOfElements order_of(std::vector<std::vector<stress::Operation>> logs,
                                stress::Stamp error) {
  OrderOfElements order;
  for (const auto& log : logs) order.operations += log.size();
  const stress::History history = stress::distinct(std::move(logs), error);
  const stress::Relaxation found = stress::measure_relaxation(stress::Matching(history));
  order.rank_error_mean = found.rank_error.mean;
  order.rank_error_p99 = found.rank_error.p99;
  order.rank_error_max = found.rank_error.max;
  order.pushes_overtaken = found.pushes_overtaken;
  order.pops_overtaken = found.pops_overtaken;
  return order;
}

/// Puts the fields of the order into `run`: means over the repetitions, and the largest rank error
/// of all; null where there are none.
inline void add_order(nlohmann::ordered_json& run, std::span<const OrderOfElements> repetitions) {
  using Json = nlohmann::ordered_json;
  const auto mean = [&](auto OrderOfElements::*figure) -> Json {
    if (repetitions.empty()) return nullptr;
    double sum = 0;
    for (const OrderOfElements& each : repetitions) sum += static_cast<double>(each.*figure);
    return sum / static_cast<double>(repetitions.size());
  };
  Json largest;
  if (!repetitions.empty())
    largest = std::ranges::max(repetitions, {}, &OrderOfElements::rank_error_max).rank_error_max;
  add(run, {{"rank_error_mean", mean(&OrderOfElements::rank_error_mean)},
            {"rank_error_p99", mean(&OrderOfElements::rank_error_p99)},
            {"rank_error_max", largest},
            {"pushes_overtaken", mean(&OrderOfElements::pushes_overtaken)},
            {"pops_overtaken", mean(&OrderOfElements::pops_overtaken)},
            {"order_operations", mean(&OrderOfElements::operations)}});
}

}  // namespace irt::results
