/// A simulated machine: threads of instrumented code on virtual cores, in simulated time.
///
///     Machine machine(load_profile("granite-rapids-96"), place(profile, 64), seed);
///     machine.set_up([&] { queue = ...; });                    // thread 0, costs nothing
///     const Ending ending = machine.run(0, 2e6, [&](unsigned thread) {
///       while (!machine.over()) { queue->push(thread, 1); machine.work(85); ... }
///     });
///
/// Every access of the instrumented code to shared memory happens at a moment of simulated time,
/// and all happen in the order of these moments (ties: lines first, then first come, first served).
/// So what the code computes is what it would compute on a sequentially consistent machine with
/// these delays, and an operation takes effect when the simulated directory grants its line.
///
/// One exception makes private data fast: accesses to a line that no other thread has ever used,
/// and reads of a line that nobody has ever written to in simulated time, may run ahead of the
/// others by `Accesses::private_window`. They are still made one after the other, on the real
/// memory; only who comes first when that ends may differ by that much.
///
/// What the host's code does between calls of the instrumented code (`body`) takes no time.
///
/// An event of the code goes down through the parts of the machine, and none calls one above it:
///
///     tenant -> C library -> kernel -> accesses -> event loop -> stores, run queues -> directory
///
/// Not modelled: weaker memory orders than the machine's store buffer gives; see mesi.hpp,
/// heap.hpp and docs/simulator.md for what else.
#pragma once

#include <functional>
#include <vector>

#include "bench/many_core/machine/tenant.hpp"

namespace irt::many_core {

class Machine {
 public:
  /// `hardware_threads[i]` is where thread i runs, by the profile's numbers (placement.hpp).
  Machine(const Profile& profile, const std::vector<unsigned>& hardware_threads,
          std::uint64_t seed);

  /// Runs `body` as thread 0, outside of simulated time. Throws std::runtime_error where the code
  /// cannot go on.
  void set_up(const std::function<void()>& body);

  /// Runs `body(thread)` on every thread, from time 0. What happens from `count_from` on is
  /// counted, `over()` is true from `until` on.
  Ending run(Time count_from, Time until, const EventLoop::Body& body);

  // Within `body`.
  /// Whether time is up for the calling thread.
  [[nodiscard]] bool over() const { return clock() >= state_.measurement.end; }
  /// Where the calling thread is.
  [[nodiscard]] Time clock() const { return state_.current->clock; }
  /// `ns` of work that no other thread can see or disturb.
  void work(double ns);
  /// The same, and then what the others have done meanwhile is done.
  void idle(double ns);
  /// A step that waited in vain; counted here so that a sleeping loop's rounds are, too.
  void count_failure() { ++state_.current->failures; }

  /// Whether what happens at `time` is counted.
  [[nodiscard]] bool counts_at(Time time) const { return state_.measurement.covers(time); }
  /// The latest moment that any thread has reached.
  [[nodiscard]] Time last_clock() const;

  [[nodiscard]] std::uint64_t failures(unsigned thread) const {
    return state_.threads[thread].failures;
  }
  /// Of all threads, from `count_from` on.
  [[nodiscard]] const Counts& counts() const { return state_.measurement.counts; }
  [[nodiscard]] const Directory& directory() const { return state_.directory; }
  [[nodiscard]] const Heap& heap() const { return heap_; }

 private:
  Heap heap_;
  EventLoop loop_;
  State& state_;
  Accesses accesses_;
  Kernel kernel_;
  CLibrary library_;
  MachineTenant tenant_;
};

}  // namespace irt::many_core
