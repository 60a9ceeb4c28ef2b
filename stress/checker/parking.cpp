#include "stress/checker/parking.hpp"

#include <memory>
#include <optional>

#include "stress/checker/batteries.hpp"
#include "stress/checker/checker.hpp"
#include "stress/scenarios/core.hpp"

namespace irt::checker {

namespace {

/// What a thread alone finds when it pops from an empty queue, closed before or not.
std::optional<FindingKind> found_alone(const QueueEntry& entry, virtual_cores::Module& module,
                                       bool closes) {
  Program program;
  program.module = &module;
  program.prepare = [&entry, closes] {
    AnyWorkQueue<std::uint64_t>* queue = entry.make_word_queue(1, 1).release();
    if (closes) queue->push(0, stress::close_word);
    std::uint64_t value = 0;
    queue->pop(0, value);
    delete queue;
  };
  program.threads.emplace_back([] {});
  Options options;
  options.seconds = 2;     // who waits is known for that much sooner
  options.executions = 8;  // more than one where the checker learns something and begins anew
  options.limits.races = false;
  options.limits.leaks = false;
  const Result result = check(program, options);
  return result.finding ? std::optional(result.finding->kind) : std::nullopt;
}

}  // namespace

bool pop_waits_until_closed(const QueueEntry& entry, virtual_cores::Module& module) {
  const auto open = found_alone(entry, module, false);
  return (open == FindingKind::deadlock || open == FindingKind::livelock) &&
         !found_alone(entry, module, true);
}

std::vector<std::string> parking_battery(const Claims& claims) {
  return fitting({"E|D;C", "C|D", "E:D|C", "ED|ED;C", "EE|DD;C", "E|E|DD;C", "EE|D|D;C", "E|C|D",
                  "C|D|D", "E|E|D|D;C", "EC|D|D", "ED|E|D;C", "EE|ED|DD;C", "EEE|D|DD;C", "E;X",
                  "E|E;X", "EE|D;X", "EEC|D;X"},
                 claims);
}

}  // namespace irt::checker
