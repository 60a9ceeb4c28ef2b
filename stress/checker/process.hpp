/// Code that is a program of its own: it begins threads, waits for their ends, and ends itself.
///
/// A thread that the code begins has a place from the start on and is *born* when the code says so.
/// Its first event reads what its birth has stored, its last one stores that it has ended, which is
/// what `join` waits for: to the memory model these are atomic objects as any other. Which place a
/// thread gets depends only on who begins it, and the how manieth of that one's it is: so threads
/// are the same in executions that begin them in different orders.
///
/// When the program ends, threads that are left go on until they end or wait: between a last step
/// of `main` and the end of the process there is any amount of time.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "stress/checker/accesses.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

class Process final : public virtual_cores::Process {
 public:
  Process(ExecutionState& state, Turns& turns, Accesses& accesses)
      : state_(state), turns_(turns), accesses_(accesses), births_(state.threads) {}

  /// The next execution begins.
  void begin();

  unsigned begin_thread(void (*entry)(void*), void* argument, const void* pc) override;
  void join(unsigned core, const void* pc) override;
  void exit(int status, const void* pc) override;
  [[noreturn]] void dismiss(const void* pc) override;

  /// "begins thread 2", "waits until thread 2 has ended": what an event of the code's at `address`
  /// is; "" if it is none of these.
  static std::string what_is(std::uintptr_t address, bool writes);

  /// Whether `thread` had calls in progress when the process ended, that of `exit` included.
  [[nodiscard]] bool in_midst(unsigned thread) const {
    return !births_[thread].returned || !turns_.of(thread).done;
  }
  /// Whether `address` stands for the birth or the end of a thread.
  static bool is_of_threads(std::uintptr_t address);

  /// The threads of the last execution in the order in which they were born.
  [[nodiscard]] const std::vector<unsigned>& born() const { return born_; }

 private:
  struct Birth {
    unsigned children = 0;  ///< begun by this thread so far
    void (*entry)(void*) = nullptr;
    void* argument = nullptr;
    bool returned = false;  ///< from its entry
  };

  unsigned place_of_child(unsigned parent);
  void live();

  ExecutionState& state_;
  Turns& turns_;
  Accesses& accesses_;
  std::map<std::pair<unsigned, unsigned>, unsigned> places_;  ///< by parent and number
  std::vector<Birth> births_;                                 ///< by thread
  std::vector<unsigned> born_;
};

}  // namespace irt::checker
