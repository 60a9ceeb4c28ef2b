/// The memory orders that the code has, and those that it is given instead, to learn what each is
/// needed for.
#pragma once

#include <unordered_map>
#include <utility>
#include <vector>

#include "stress/checker/graph.hpp"

namespace irt::checker {

/// An order in the code: where, of what, and which.
struct OrderSite {
  const void* pc;
  bool failure;  ///< of a compare-exchange that fails
  EventKind kind;
  Order order;
};

class MemoryOrders {
 public:
  /// Notes orders from now on.
  void watch() { watches_ = true; }
  /// The orders met since, each once.
  [[nodiscard]] const std::vector<OrderSite>& sites() const { return sites_; }
  /// From now on, the code's order at these places is another one.
  void weaken(const std::vector<std::pair<OrderSite, Order>>& changes) {
    watches_ = watches_ || !changes.empty();
    for (const auto& [site, order] : changes) instead_[site.failure ? 1 : 0][site.pc] = order;
  }

  /// From now on orders are at least what x86 makes of them.
  void strengthen_as_x86() { x86_ = true; }

  /// The order that counts where the code at `pc` says `order`.
  Order at(const void* pc, bool failure, EventKind kind, Order order) {
    if (x86_ && order != Order::seq_cst && kind != EventKind::fence)
      return kind == EventKind::load || failure ? Order::acquire
             : kind == EventKind::store         ? Order::release
                                                : Order::acq_rel;
    if (!watches_) return order;
    auto [place, fresh] = instead_[failure ? 1 : 0].try_emplace(pc, order);
    if (fresh) sites_.push_back({pc, failure, kind, order});
    return place->second;
  }

 private:
  bool watches_ = false;
  bool x86_ = false;
  std::vector<OrderSite> sites_;
  std::unordered_map<const void*, Order> instead_[2];  ///< of success, of failure
};

}  // namespace irt::checker
