/// Every cache line, and the requests that queue at each: a line serves one at a time.
///
/// Who of those that wait is served next says arbitration.hpp; what that makes of the line, and
/// what it costs, mesi.hpp.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "bench/many_core/coherence/line.hpp"
#include "bench/many_core/coherence/mesi.hpp"

namespace irt::many_core {

class Directory {
 public:
  Directory(const Profile& profile, EventQueue& events, std::uint64_t seed);

  /// The line, or null if it was never used.
  [[nodiscard]] Line* find(std::uint64_t number) const {
    std::size_t at = slot_of(number);
    while (slots_[at].line != nullptr) {
      if (slots_[at].number == number) return slots_[at].line;
      at = (at + 1) & (slots_.size() - 1);
    }
    return nullptr;
  }
  Line& make(std::uint64_t number);

  /// Sends `request`, which must live until it is served.
  void send(Line& line, Request& request, Time now);

  struct Served {
    Request* request;
    Time done;
    bool moved;  ///< not, where the core held the line by then
  };
  /// The line's event, at a moment when it is free: serves one request.
  Served serve(Line& line, Time now);

  /// Forgets what was noted of lines so far.
  void reset_statistics();

  [[nodiscard]] const std::deque<Line>& lines() const { return lines_; }
  [[nodiscard]] const Topology& topology() const { return mesi_.topology(); }

 private:
  struct Slot {
    std::uint64_t number = 0;
    Line* line = nullptr;
  };

  [[nodiscard]] std::size_t slot_of(std::uint64_t number) const {
    return static_cast<std::size_t>(number * 0x9E3779B97F4A7C15U >> shift_);
  }
  void grow();
  Request& take_next(Line& line, Time now);
  static void note(Line& line, const Request& request, Time done);

  EventQueue& events_;
  Mesi mesi_;
  unsigned sockets_, bypass_;
  bool in_turn_;
  std::vector<Slot> slots_;
  unsigned shift_;
  std::deque<Line> lines_;
  std::deque<Waiting> waitings_;
  std::vector<Waiting*> unused_;  // of `waitings_`
};

}  // namespace irt::many_core
