/// Who gets a line next, of those who wait for it.
///
/// Each of those that have arrived is as likely to be the next as any other; drawn from the seed.
///
/// In turn (`turns` of the profile): requests are served in rounds, and in a round every core that
/// waits is served once; it is drawn from those that were not served yet. When all who wait have
/// had their turn, or nobody waits, a new round begins. So of n cores that wait all the time nobody
/// waits for more than 2 (n - 1) others, and of compare-and-swaps that have all seen the same value
/// exactly one succeeds in a round.
///
/// Distance: while cores of the socket that had the line last and cores of another socket may be
/// next, the former are preferred, `bypass` times in a row; then, and when a round begins, the next
/// is drawn from all.
///
/// What it stands for: a home that turns away what meets a request for the same address, to be
/// tried again (Intel's uncore manuals count such rejects), so that who comes through depends on
/// paths and retries that nobody sees. That schedules of real machines look random to a lock-free
/// loop is what Alistarh, Censor-Hillel and Shavit rest on in "Are Lock-Free Concurrent Algorithms
/// Practically Wait-Free?" (2014). A client's ring behaves as if all had their turn;
/// docs/simulator.md has the figures. Strict order of arrival is not used, for it locks into step:
/// whoever has succeeded in a compare-and-swap loop is the first to know the new value when its
/// turn comes again, and wins for ever.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/many_core/coherence/core_set.hpp"
#include "bench/many_core/coherence/events.hpp"
#include "bench/many_core/coherence/random.hpp"

namespace irt::many_core {

enum class Want : std::uint8_t {
  copy,       ///< to read
  ownership,  ///< to write
  far,        ///< to have a read-modify-write done at the home
};

/// A core asks for a line.
struct Request {
  Time issued = 0;
  Time arrival = 0;  ///< at the line
  const void* pc = nullptr;
  std::uint64_t bytes = 0;  ///< of the line, that it wants to use
  Time takes = 0;           ///< the operation itself, at its core
  std::uint32_t thread = 0;
  std::uint32_t core = 0;
  Want want = Want::copy;
  bool posted = false;  ///< nobody waits
};

/// The requests that wait at one line.
class Waiting {
 public:
  /// With `in_turn` nobody is served twice in a round.
  Waiting(unsigned sockets, bool in_turn) : sockets_(sockets), in_turn_(in_turn) {}

  [[nodiscard]] unsigned count() const { return count_; }

  /// `request` must live until it is taken. Nobody is taken before `busy_until`.
  void add(Request& request, unsigned socket, Time busy_until) {
    if (count_++ == 0) {
      served_.clear();
      bypassed_ = 0;
    }
    if (request.arrival <= busy_until) {
      arrive(request, socket);
    } else {
      set_out(request, socket);
    }
  }

  /// The earliest moment when somebody is there; there must be a request.
  [[nodiscard]] Time earliest() const {
    return arrived_ != 0 ? 0 : under_way_.front().request->arrival;
  }

  /// Takes the request whose turn it is at `now`, not before `earliest()`. `near` is the socket
  /// that had the line last, or `nobody`.
  Request& take(Time now, unsigned near, unsigned bypass, Random& random);

 private:
  struct Socket {
    std::vector<Request*> due;     // in this round
    std::vector<Request*> served;  // and here again, for the next one
  };
  struct OnItsWay {
    Request* request;
    unsigned socket;
  };

  void arrive(Request& request, unsigned socket) {
    ++arrived_;
    if (in_turn_ && served_.has(request.core)) {
      sockets_[socket].served.push_back(&request);
    } else {
      sockets_[socket].due.push_back(&request);
      ++due_;
    }
  }
  void set_out(Request& request, unsigned socket);
  void admit(Time now);
  void begin_round();

  std::vector<Socket> sockets_;
  bool in_turn_;
  std::vector<OnItsWay> under_way_;  // by arrival
  CoreSet served_;                   // in this round, if all are served in turn
  unsigned count_ = 0, arrived_ = 0, due_ = 0;
  unsigned bypassed_ = 0;  // how often in a row
};

}  // namespace irt::many_core
