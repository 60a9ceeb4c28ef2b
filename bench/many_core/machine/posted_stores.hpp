/// Stores that no thread waits for: they take effect in program order, each when it has its line.
///
/// The first one's request is under way; the next one's is sent when that has been served, so that
/// their transfers overlap but for the way to the line.
#pragma once

#include "bench/many_core/machine/state.hpp"

namespace irt::many_core {

class PostedStores {
 public:
  PostedStores(const Profile& profile, State& state);

  /// Adds a store that is issued now; `me.stores` must have a place.
  void post(Thread& me, const PostedStore& store);
  /// The thread's first store has its line, and takes effect: until `done` nobody else can look.
  /// The thread goes on if it waits for that.
  void commit(Thread& me, Line& line, Time done);

 private:
  void issue(Thread& me, Time now);

  State& state_;
  Time store_hit_;
};

}  // namespace irt::many_core
