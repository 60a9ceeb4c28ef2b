/// What is checked, and within what limits.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stress/checker/ageing.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

class Execution;

/// A small concurrent program. The functions call into instrumented code; what they do themselves
/// is not seen, so they must be the same in every execution and keep nothing on their stacks that
/// needs destruction.
struct Program {
  std::vector<std::function<void()>> threads;
  /// So many more the code may begin itself, at most; it is a process then, which it may also end.
  unsigned own_threads = 0;
  /// So many calls of `grow_older`, numbered from 0, come before `prepare`: natively, and once for
  /// all executions (see ageing.hpp). Programs with equal `aged_what` do the same there and may
  /// share what came of it.
  std::uint64_t age = 0;
  std::function<void(std::uint64_t)> grow_older;
  std::string aged_what;
  std::shared_ptr<AgedMemory> aged;
  std::function<void()> prepare;  ///< before the threads; may be empty
  std::function<void()> finish;   ///< after all threads ended; may be empty
  /// After everything: what is wrong with the outcome, if anything. Runs outside of the cores.
  std::function<std::optional<std::string>(const Execution&)> judge;
  /// What tells the outcomes that the judge was asked about from each other, a number for each; may
  /// be empty.
  std::function<std::vector<std::uint64_t>()> histories{};
  /// The number of the outcome that the judge was asked about last; equal threads of a program
  /// with a judge are not exchanged without it.
  std::function<std::uint64_t()> outcome{};
  virtual_cores::Module* module = nullptr;  ///< its globals start afresh each time
  std::function<void()> afresh{};           ///< before each execution, outside of the cores
  /// By thread: those of one number seem to do the same; empty: none do. See exchange.hpp.
  std::vector<unsigned> roles{};
};

struct Limits {
  /// A thread that makes more ends the execution, which then proves nothing. At most 60,000.
  std::size_t events_per_thread = 20'000;
  /// A thread that runs alone and only counts its rounds is taken for endless after so many looks.
  std::uint64_t looks = std::uint64_t{1} << 20U;
  /// A loop is taken to wait if it reads the same store at the same place this often in a row; and
  /// no place reads one more often while there is a newer one.
  unsigned same_reads = 20;
  /// A thread is taken to wait if it makes so many events without reading anything new.
  std::size_t events_without_news = 400;
  bool reuse_memory = false;         ///< a thread may get back what it freed, as a choice
  unsigned failing_allocations = 0;  ///< so many in an execution may fail, each as a choice
  bool weak_may_fail = false;        ///< compare_exchange_weak fails for no reason, as a choice
  bool spurious_wakeups = false;     ///< futex and condition waits end for no reason, as a choice
  bool leaks = true;                 ///< blocks that are never freed are findings
  /// What is allocated where the code never frees anything is a leak, too.
  bool kept_memory_leaks = true;
  bool uninitialised = true;  ///< reads of memory that nothing was written to are findings
  /// Executions are those of x86 hardware: its orders are stronger than the code may ask for.
  bool on_x86 = false;
  bool races = true;  ///< data races are findings; if not, plain reads see what memory holds
};

}  // namespace irt::checker
