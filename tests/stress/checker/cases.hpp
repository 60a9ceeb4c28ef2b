/// The queues of tests/stress/cases, each with its right verdict. A case stands for its kind; its
/// sisters are rows beside it.
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/queue_check.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace irt::checker {

struct Case {
  std::string_view queue;
  std::vector<FindingKind> right;  ///< any of these; none: healthy
};

// clang-format off
inline const std::vector<Case> cases{
    {"waits-for-recycled-bug", {FindingKind::livelock}},
    {"waits-for-recycled-counted-bug", {FindingKind::livelock}},
    {"waits-for-recycled-stored-bug", {FindingKind::livelock}},
    {"waits-for-recycled-fixed", {}},
    {"one-short-bug", {FindingKind::wrong_outcome}},
    {"one-short-producers-bug", {FindingKind::wrong_outcome}},
    {"one-short-unordered-bug", {FindingKind::wrong_outcome}},
    {"one-short-fixed", {}},
    {"unpublished-bug", {FindingKind::data_race}},
    {"unpublished-fixed", {}},
    {"dropped-list-uses-bug", {FindingKind::use_after_free}},
    {"dropped-list-leaks-bug", {FindingKind::leak}},
    {"dropped-list-twice-bug", {FindingKind::double_free}},
    {"dropped-list-fixed", {}},
    {"dropped-ring-looks-bug", {FindingKind::livelock}},
    {"dropped-ring-wipes-bug", {FindingKind::livelock}},
    {"dropped-ring-fixed", {}},
    {"long-spin", {}},
    {"notified-twice-bug", {FindingKind::deadlock}},
    {"notified-twice-fixed", {}},
    {"closed-in-turn", {}},
    {"two-at-a-time", {}},
    {"two-at-a-time-for-one", {}},
    {"two-at-a-time-forgets-bug", {FindingKind::wrong_outcome}},
    {"two-at-a-time-races-bug", {FindingKind::data_race}},
    {"drops-closed-bug", {FindingKind::wrong_outcome}},
    {"refuses-too-soon-bug", {FindingKind::deadlock, FindingKind::wrong_outcome}},
    {"waits", {}},
    {"full-in-flight", {}},
    {"waits-impatient-bug", {FindingKind::wrong_outcome}},
    {"waits-deaf-bug", {FindingKind::wrong_outcome, FindingKind::deadlock}},
    {"waits-accepts-bug", {FindingKind::wrong_outcome}},
    {"waits-leaves-behind-bug", {FindingKind::wrong_outcome}},
    {"pops-for-ever-bug", {FindingKind::deadlock}},
    {"element-ring", {}},
    {"element-ring-tears-bug", {FindingKind::data_race}},
    {"element-ring-twice-bug", {FindingKind::double_free, FindingKind::use_after_free}},
    {"element-ring-counts-early-bug", {FindingKind::failure, FindingKind::wrong_outcome}},
    {"proposed", {}},
    {"proposed-deaf-bug", {FindingKind::deadlock}},
    {"bulky", {}},
    {"bulky-drops-bug", {FindingKind::wrong_outcome}},
    {"bulky-backwards-bug", {FindingKind::wrong_outcome}},
    {"bulky-boasts-bug", {FindingKind::wrong_outcome}},
    {"shared-line-bug", {}},  // it is slow, and right
    {"shared-line-fixed", {}},
    {"chase", {}},
    {"many-sc", {}},
    {"load-time", {}},
    {"load-time-grown", {}},
    {"registry", {}},
    {"narrow-index-bug", {FindingKind::wrong_outcome}},
    {"narrow-index-16-bug", {FindingKind::wrong_outcome}},
    {"narrow-index-fixed", {}},
    {"failed-growth-bug", {FindingKind::livelock}},
    {"failed-growth-fixed", {}},
    {"tagged-top", {}},
    {"tagged-low", {}},
    {"tagged-inside", {}},
    {"tagged-bug", {FindingKind::leak}},
    {"call-result-bug", {FindingKind::data_race}},
    {"call-result-fixed", {}},
    {"sanitizer-macro-bug", {FindingKind::data_race}},
    {"list-queue", {}},
    {"endless-wait-bug", {FindingKind::livelock}},
    {"endless-pause-bug", {FindingKind::livelock}},
    {"endless-yield-bug", {FindingKind::livelock}},
    {"endless-call-bug", {FindingKind::livelock}},
    {"endless-rounds-bug", {FindingKind::livelock}},
    {"endless-fixed", {}},
    {"computes-a-while", {}},
    {"traps-bug", {FindingKind::failure}},
    {"divides-bug", {FindingKind::failure}},
    {"breaks-bug", {FindingKind::failure}},
    {"traps-fixed", {}},
    {"gives-up-bug", {FindingKind::data_race}},
    {"gives-up-mutex-bug", {FindingKind::data_race}},
    {"tried-mutex", {}},
    {"tried-spin-lock", {}},
    {"sleeping-flag", {}},
    {"polled-flag", {}},
    {"walked-places", {}},
    {"timed-mutex", {}},
    {"timed-shared-mutex", {}},
    {"timed-rw-lock", {}},
    {"timed-semaphore", {}},
    {"timed-std-semaphore", {}},
    {"timed-c11-mutex", {}},
    {"times-out-mutex-bug", {FindingKind::data_race}},
    {"times-out-rw-lock-bug", {FindingKind::data_race}},
    {"times-out-semaphore-bug", {FindingKind::data_race}},
    {"times-out-c11-bug", {FindingKind::data_race}},
    {"mapped-pages", {}},
    {"mapped-aligned", {}},
    {"mapped-uses-bug", {FindingKind::use_after_free}},
    {"mapped-aligned-uses-bug", {FindingKind::use_after_free}},
    {"mapped-leaks-bug", {FindingKind::leak}},
    {"posix-key", {}},
    {"c11-key", {}},
    {"posix-key-leaks-bug", {FindingKind::leak}},
    {"large-frames", {}},
    {"endless-recursion-bug", {FindingKind::failure}},
};
// clang-format on

class Cases : public testing::Test {
 protected:
  const QueueEntry& entry(std::string_view name) { return probe_entry(module_, name); }

  QueueResult check(std::string_view queue, double seconds, bool reports = false) {
    CheckSettings settings;
    settings.quiet = true;
    settings.reports = reports;
    settings.seconds = seconds;
    return check_queue(entry(queue), module_, settings, "");
  }

  /// "livelock on EE:DE|D", or "nothing".
  static std::string finding_of(const QueueResult& result, FindingKind* kind = nullptr) {
    for (const ShapeResult& shape : result.shapes) {
      if (!shape.result.finding) continue;
      if (kind != nullptr) *kind = shape.result.finding->kind;
      return std::string(name_of(shape.result.finding->kind)) + " on " + shape.shape + ": " +
             shape.result.finding->text;
    }
    return "nothing";
  }

  virtual_cores::Module module_{IRT_CASES_PROBE};
};

}  // namespace irt::checker
