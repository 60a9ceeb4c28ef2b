#include "stress/checker/standstill.hpp"

#include <string>

namespace irt::checker {

namespace {

bool has_seen_all(const ExecutionState& state, const Turns& turns, const Loops& loops,
                  unsigned thread) {
  if (turns.of(thread).location == 0) return loops.sees_newest(thread);
  const Graph& graph = state.graph;
  const std::vector<EventId>& events = graph.thread(thread).events;
  if (events.empty()) return true;
  const Event& last = graph.event(events.back());
  return !last.blocked || is_newest(graph, source_of(graph, last.from));
}

Finding explained(const ExecutionState& state, const Turns& turns) {
  Finding finding{FindingKind::deadlock, "", {}};
  for (unsigned thread = 0; thread < state.threads; ++thread) {
    const Turns::Thread& t = turns.of(thread);
    if (t.done || t.unborn) continue;
    const std::string place = "{" + std::to_string(finding.places.size()) + "}";
    finding.places.push_back(t.wait_pc);
    if (!finding.text.empty()) finding.text += "; ";
    finding.text += "thread " + std::to_string(thread);
    if (t.sleeps) {
      finding.text += " sleeps at " + place + " and nobody is left to wake it";
    } else if (t.location != 0) {
      finding.text += " waits at " + place + " for " + t.wait_for;
    } else {
      finding.text += " loops at " + place + " for a store that nobody makes";
      finding.kind = FindingKind::livelock;
    }
  }
  if (const auto& frozen = turns.frozen()) {
    finding.kind = FindingKind::blocked_by_stalled_thread;
    finding.text = "with thread " + std::to_string(frozen->first) + " stopped after " +
                   std::to_string(frozen->second) + " steps, " + finding.text;
  }
  return finding;
}

}  // namespace

void conclude_standstill(ExecutionState& state, const Turns& turns, const Loops& loops) {
  if (turns.over()) return;
  bool all_ended = true;
  for (unsigned thread = 0; thread < state.threads; ++thread) {
    const Turns::Thread& t = turns.of(thread);
    if (t.done || t.unborn) continue;
    all_ended = false;
    // It is for good only if each has seen the newest store of all it waits for.
    if (t.timed || t.assumed || (!t.endless && !has_seen_all(state, turns, loops, thread)))
      return state.conclusion.end(Outcome::blocked);
  }
  if (!all_ended) state.conclusion.find(explained(state, turns));
}

}  // namespace irt::checker
