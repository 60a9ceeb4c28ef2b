#include "stress/checker/parking.hpp"

#include "stress/checker/checker.hpp"

namespace irt::checker {

bool pop_waits(const QueueEntry& entry, virtual_cores::Module& module) {
  Program program;
  program.module = &module;
  program.prepare = [&entry] {
    AnyWorkQueue<std::uint64_t>* queue = entry.make_word_queue(1, 1).release();
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
  return result.finding && (result.finding->kind == FindingKind::deadlock ||
                            result.finding->kind == FindingKind::livelock);
}

}  // namespace irt::checker
