#include "stress/checker/result_bytes.hpp"

#include <utility>
#include <vector>

namespace irt::checker {

static_assert(sizeof(Finding) == sizeof(std::string) + 2 * sizeof(std::vector<int>) + 8,
              "a finding has a new field, which to_bytes and from_bytes must send too");

std::string to_bytes(const Result& r) {
  Writer w;
  w.put(r.finding.has_value());
  if (r.finding) {
    w.put(r.finding->kind);
    w.put_all(r.finding->text);
    w.put_all(r.finding->places);
    w.put(r.finding->moments.size());
    for (const Moment& moment : r.finding->moments) {
      w.put(moment.thread);
      w.put(moment.after);
      w.put(moment.pc);
      w.put_all(moment.what);
      w.put_all(moment.note);
    }
  }
  w.put_all(r.schedule.steps);
  w.put(r.schedule.waiting_resumes);
  w.put_all(r.order_sites);
  w.put_all(r.histories);
  w.put_all(r.incomplete);
  w.put(r.differs);
  w.put(r.incomplete_at);
  w.put_all(r.time_went);
  for (const std::uint64_t count : {r.executions, r.complete, r.blocked, r.cut}) w.put(count);
  w.put(r.assumed_waits);
  w.put(r.threads);
  w.put(r.allocates);
  w.put(r.finished);
  w.put(r.explored);
  w.put(r.seconds);
  w.put_all(r.never_freed);
  w.put(r.exchanged);
  w.put_all(r.uneven);
  return std::move(w.bytes);
}

Result from_bytes(const std::string& bytes) {
  Reader in{bytes};
  Result r;
  if (in.take<bool>()) {
    r.finding.emplace();
    r.finding->kind = in.take<FindingKind>();
    r.finding->text = in.take_all<std::string>();
    r.finding->places = in.take_all<std::vector<const void*>>();
    for (auto left = in.take<std::size_t>(); left > 0; --left) {
      Moment moment;
      moment.thread = in.take<unsigned>();
      moment.after = in.take<std::uint16_t>();
      moment.pc = in.take<const void*>();
      moment.what = in.take_all<std::string>();
      moment.note = in.take_all<std::string>();
      r.finding->moments.push_back(std::move(moment));
    }
  }
  r.schedule.steps = in.take_all<std::vector<Step>>();
  r.schedule.waiting_resumes = in.take<bool>();
  r.order_sites = in.take_all<std::vector<OrderSite>>();
  r.histories = in.take_all<std::vector<std::uint64_t>>();
  r.incomplete = in.take_all<std::string>();
  r.differs = in.take<bool>();
  r.incomplete_at = in.take<const void*>();
  r.time_went = in.take_all<std::string>();
  for (std::uint64_t* count : {&r.executions, &r.complete, &r.blocked, &r.cut})
    *count = in.take<std::uint64_t>();
  r.assumed_waits = in.take<std::size_t>();
  r.threads = in.take<unsigned>();
  r.allocates = in.take<bool>();
  r.finished = in.take<bool>();
  r.explored = in.take<double>();
  r.seconds = in.take<double>();
  r.never_freed = in.take_all<std::vector<const void*>>();
  r.exchanged = in.take<Exchanged>();
  r.uneven = in.take_all<std::string>();
  return r;
}

}  // namespace irt::checker
