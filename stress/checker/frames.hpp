/// Where functions of a program's threads have returned, for what other threads still do to their
/// variables: what one does must happen before the function returns.
///
/// That a function returns is no event, so that an execution does not depend on when it does; it is
/// placed between two events of its thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "stress/checker/clock.hpp"

namespace irt::checker {

class Frames {
 public:
  struct Return {
    std::uint16_t after;  ///< so many events of the thread
    std::uintptr_t end;   ///< the stack below is no more
    const void* pc;
  };

  explicit Frames(unsigned threads) : threads_(threads) {}

  /// The next execution begins.
  void begin() {
    for (Thread& thread : threads_) {
      thread.returns.clear();
      thread.touched.clear();
    }
  }

  /// A function of `thread` returns.
  void leave(unsigned thread, const Return& last) {
    std::vector<Return>& returns = threads_[thread].returns;
    while (!returns.empty() && returns.back().end <= last.end) returns.pop_back();
    returns.push_back(last);
  }

  /// Somebody else touches the eight bytes at `address` on the stack of `thread`, of whose events
  /// it knows `known`. Returns which function with this variable has returned by then, or may have.
  std::optional<Return> touch(unsigned thread, std::uintptr_t address, std::uint16_t known) {
    threads_[thread].touched.insert(address);
    const std::vector<Return>& returns = threads_[thread].returns;
    const auto first = std::ranges::lower_bound(returns, known, {}, &Return::after);
    if (first == returns.end() || first->end <= address) return std::nullopt;
    return *first;
  }

  /// The lowest eight bytes of the stack of `thread` that another one has touched, if they are
  /// below `end`; forgets them.
  std::optional<std::uintptr_t> take_touched(unsigned thread, std::uintptr_t end) {
    std::set<std::uintptr_t>& touched = threads_[thread].touched;
    if (touched.empty() || *touched.begin() >= end) return std::nullopt;
    return touched.extract(touched.begin()).value();
  }

 private:
  struct Thread {
    std::vector<Return> returns;  ///< each further down than those before it
    std::set<std::uintptr_t> touched;
  };
  std::vector<Thread> threads_;
};

}  // namespace irt::checker
