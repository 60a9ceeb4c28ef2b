/// A history ordered by happens-before, and the question whether a queue could have made it.
///
/// Call a precedes call b when the return from a happens before b is called. Calls that are not so
/// ordered overlap, however far apart an explorer happened to run them; so code whose orders are as
/// weak as they may be is not accused of what only a clock could see.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/checker/clock.hpp"

namespace irt::checker {

/// One call of a queue.
struct QueueCall {
  enum class Kind : std::uint8_t { push, pop, close, leave } kind = Kind::push;
  bool waits = false;      ///< a waiting pop
  unsigned thread = 0;     ///< who called; the drain and the prologue are the preparing thread's
  unsigned worker = 0;     ///< on whose behalf
  std::size_t number = 0;  ///< of the call, as the execution made them
  enum class Phase : std::uint8_t { before, during, after } phase = Phase::during;
  bool answered = false;   ///< what the call returned
  bool finished = false;   ///< whether it returned at all
  bool no_memory = false;  ///< it had no effect, since there was no memory, and said so
  bool untried = false;    ///< of a call for several elements: it did not come to this one
  bool timed_out = false;  ///< a waiting pop that gave up at its deadline
  /// A waiting pop that was told so; or a push that was refused, as it may be once the queue is
  /// closed.
  bool closed = false;
  std::uint64_t value = 0;
  Clock called{};                 ///< what happens before the call
  bool ends_frame = false;        ///< it answered that there will be no more tasks ...
  Clock before_return{};          ///< ... and this is what happens before that
  std::uint16_t returned = 0;     ///< the moment of its thread at which it returned
  std::uint64_t called_at = 0;    ///< by the execution's clock, see Kernel::tick; 0: not asked
  std::uint64_t returned_at = 0;  ///< likewise
  std::size_t first_step = 0;     ///< steps of the execution before the call
  std::size_t last_step = 0;      ///< and before the return
};

/// Whether `a` returns before `b` is called, as far as the code can know or a clock has seen.
bool precedes(const QueueCall& a, const QueueCall& b);

/// "push 3", "pop", "pop_wait", "close", "leave".
std::string name_of(const QueueCall& operation);
/// What it answered: "full", "3", "empty", "closed"; empty for what was done.
std::string answer_of(const QueueCall& operation);
/// "push 3 -> full", "pop -> 3", "pop -> empty".
std::string to_string(const QueueCall& operation);

/// How the judge's sentence names a push that was told "full" wrongly.
std::string refusal(const QueueCall& push);

struct Opinion {
  std::optional<std::string> wrong;  ///< one sentence; none: as claimed
  bool decided = true;               ///< false: too many orders to try; that proves nothing
};

/// What is wrong with `operations` by the claims, if anything, as stress/history/specification.hpp
/// has it. All operations are finished, the last ones empty the queue if it is `emptied`; phases
/// follow each other.
Opinion judge(const std::vector<QueueCall>& operations, const Claims& claims, std::size_t capacity,
              bool emptied = true);

/// What is wrong with `operations`, some of them not finished, since worker `stopped` was stopped
/// for good: an element whose push has returned does not come out.
std::optional<std::string> judge_stalled(const std::vector<QueueCall>& operations,
                                         const Claims& claims, std::size_t capacity,
                                         unsigned stopped);

/// The histories of one program. Few differ in what matters, the answers and the order: each is
/// judged once.
class Histories {
 public:
  Opinion judge(const std::vector<QueueCall>& operations, const Claims& claims,
                std::size_t capacity, bool emptied);
  /// The hash of the last one.
  [[nodiscard]] std::uint64_t last() const { return last_; }
  [[nodiscard]] std::vector<std::uint64_t> hashes() const;

 private:
  std::unordered_map<std::string, bool> fine_;  ///< whether nothing is wrong, by what matters
  std::uint64_t last_ = 0;
};

}  // namespace irt::checker
