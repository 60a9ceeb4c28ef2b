/// Which core a render thread runs on.
#pragma once

namespace irt {

/// Whether this build can bind threads (it has hwloc).
bool can_pin();

/// While it lives the calling thread, the `index`-th of its kind, is bound to a hardware thread, if
/// so `wanted`: every core once before any core's second hardware thread, then from the start.
class Pinned {
 public:
  Pinned(bool wanted, unsigned index);
  ~Pinned();
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

  /// False if it was not wanted, or the system has refused.
  [[nodiscard]] bool holds() const { return holds_; }

 private:
  void* before_ = nullptr;  // where the thread could run, a bitmap of hwloc's
  bool holds_ = false;
};

}  // namespace irt
