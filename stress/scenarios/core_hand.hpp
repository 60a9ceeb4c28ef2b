/// The hand of a contention scenario on a core: each operation is logged and judged.
#pragma once

#include <algorithm>
#include <cstddef>

#include "stress/scenarios/contention.hpp"
#include "stress/scenarios/core.hpp"

namespace irt::stress {

/// Works until the core's share of operations is used up. Between operations others may run; how
/// long is not this instrument's matter.
class CoreHand {
 public:
  explicit CoreHand(Core& core) : core_(core) {}

  [[nodiscard]] bool running() const { return core_.more(); }
  bool push() { return core_.push(); }
  bool pop() { return core_.pop().has_value(); }
  /// The tag is in the element's number, of which some are left out.
  bool push_tagged(unsigned tag) { return core_.push_at(contention::tags, tag); }
  bool pop_tagged(unsigned& tag) {
    const std::optional<Element> e = core_.pop();
    if (e) tag = static_cast<unsigned>(sequence_of(*e) % contention::tags);
    return e.has_value();
  }
  bool push_until_accepted() {
    return until([this] { return push(); });
  }
  bool pop_until_found() {
    return until([this] { return pop(); });
  }
  std::size_t push_bulk() { return core_.push_bulk(contention::bulk); }
  std::size_t pop_bulk(std::size_t most) {
    return core_.pop_bulk(std::min(most, contention::bulk));
  }
  bool pop_wait() { return core_.pop_wait().has_value(); }
  void close() { core_.close(); }
  bool put() {
    const bool done = push_until_accepted();
    work();
    return done;
  }
  bool put_back() { return put(); }
  bool take() {
    const bool done = pop_until_found();
    work();
    return done;
  }
  void work() { core_.idle(); }
  std::uint64_t random(std::uint64_t bound) { return core_.random(bound); }
  [[nodiscard]] bool produces() const { return core_.self().pushes; }
  [[nodiscard]] bool leads() const { return core_.self().worker == 0; }
  /// Who finds nothing leaves: how much of a tree a core's share of operations makes is open.
  static void finished_one() {}
  static bool all_finished(std::uint64_t) { return true; }
  [[nodiscard]] bool consumers_caught_up() const { return running(); }
  void rest() {
    for (std::uint64_t pause = core_.random(4); pause > 0; --pause) core_.idle();
  }
  /// All workers come equally often, whatever they have left to do.
  bool meet() {
    constexpr unsigned frames = 3;
    if (frame_++ == frames) return false;
    core_.meet();
    return true;
  }
  contention::Burst burst() { return {.size = 1 + static_cast<unsigned>(core_.random(64))}; }

 private:
  template <class Operation>
  bool until(Operation succeeds) {
    while (running()) {
      if (succeeds()) return true;
      core_.idle();
    }
    return false;
  }

  Core& core_;
  unsigned frame_ = 0;
};

}  // namespace irt::stress
