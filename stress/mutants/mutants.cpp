#include "stress/mutants/mutants.hpp"

#include <array>

#include "stress/mutants/deques.hpp"
#include "stress/mutants/linked.hpp"
#include "stress/mutants/locked.hpp"
#include "stress/mutants/parking.hpp"
#include "stress/mutants/recycled.hpp"
#include "stress/mutants/rings.hpp"
#include "stress/mutants/scenarios.hpp"
#include "stress/mutants/thesis.hpp"
#include "stress/mutants/waiting.hpp"

namespace irt::stress {
namespace {

Scenario usual(std::string_view name) {
  return *find_scenario(name);
}

/// The usual scenario on another capacity.
Scenario with_capacity(std::string_view name, std::size_t capacity) {
  Scenario scenario = usual(name);
  scenario.capacity = capacity;
  return scenario;
}

const Scenario frame_end{
    .name = "frames", .summary = "", .pushers = 3, .poppers = 3, .together = true, .run = frames};

const Scenario thieves{.name = "owner-and-thieves",
                       .summary = "",
                       .pushers = 2,
                       .poppers = 2,
                       .together = true,
                       .capacity = 16,
                       .run = owner_and_thieves};

template <template <class> class Q, template <class> class Twin>
Mutant mutant(std::string_view id, std::string_view defect, const Scenario& scenario,
              std::uint8_t seen, std::string_view needs = {}) {
  return {id, defect, queue_entry<Q>(id), queue_entry<Twin>(id), scenario, seen, needs};
}

template <LinkedBug bug>
Mutant linked(std::string_view id, std::string_view defect, std::uint8_t seen,
              std::string_view needs = {}) {
  return mutant<Linked<bug>::template Queue, Linked<LinkedBug::none>::template Queue>(
      id, defect, usual("mpmc"), seen, needs);
}
template <RecycledBug bug>
Mutant recycled(std::string_view id, std::string_view defect, const Scenario& scenario) {
  return mutant<Recycled<bug>::template Queue, Recycled<RecycledBug::none>::template Queue>(
      id, defect, scenario, by_oracles);
}
template <ParkingBug bug>
Mutant parking(std::string_view id, std::string_view defect, const Scenario& scenario) {
  return mutant<Parking<bug>::template Queue, Parking<ParkingBug::none>::template Queue>(
      id, defect, scenario, by_oracles);
}
template <SpscBug bug>
Mutant spsc(std::string_view id, std::string_view defect, const Scenario& scenario,
            std::uint8_t seen) {
  return mutant<Spsc<bug>::template Queue, Spsc<SpscBug::none>::template Queue>(id, defect,
                                                                                scenario, seen);
}
template <VyukovBug bug>
Mutant vyukov(std::string_view id, std::string_view defect, const Scenario& scenario,
              std::uint8_t seen) {
  return mutant<Vyukov<bug>::template Queue, Vyukov<VyukovBug::none>::template Queue>(
      id, defect, scenario, seen);
}
template <DequeBug bug>
Mutant stealing(std::string_view id, std::string_view defect, const Scenario& scenario,
                std::uint8_t seen, std::string_view needs = {}) {
  return mutant<Stealing<bug>::template Queue, Stealing<DequeBug::none>::template Queue>(
      id, defect, scenario, seen, needs);
}

constexpr std::string_view weak_memory =
    "a memory model: this processor's compare-and-swap is a full barrier whatever its order";

const auto& all() {
  static const std::array table{
      linked<LinkedBug::delete_now>("m01", "sentinel deleted right after the head moved",
                                    by_tsan | by_asan),
      recycled<RecycledBug::uncounted>("m02", "recycled nodes without counters: ABA",
                                       usual("ping-pong")),
      linked<LinkedBug::late_value>("m04", "value read after the head moved", by_tsan | by_asan),
      linked<LinkedBug::relaxed_publish>("m05", "node published with relaxed order", by_tsan),
      linked<LinkedBug::acquire_head>("m07", "head moved with acquire only", by_tsan),
      recycled<RecycledBug::no_help>("m09", "recycles a node that the tail still names",
                                     usual("mpmc")),
      linked<LinkedBug::hazard_release>(
          "m11", "hazard pointer published with release only", by_none,
          "store-load reordering in a window of nanoseconds: too rare "
          "to be seen every time"),
      linked<LinkedBug::scan_unordered>("m11b", "scan not ordered after the unlinking", by_none,
                                        weak_memory),
      linked<LinkedBug::scan_only_active>("m12", "scan skips threads not yet flagged active",
                                          by_tsan | by_asan),
      mutant<Paged<false>::Queue, Paged<true>::Queue>(
          "m13", "head passes a page whose next is not linked yet", usual("mpmc"), by_oracles),
      vyukov<VyukovBug::relaxed_ready>("m15", "place read before its ready flag is acquired",
                                       usual("mpmc"), by_tsan),
      mutant<TwoLock<false>::Queue, TwoLock<true>::Queue>("m18", "two locks, plain next",
                                                          usual("near-empty"), by_tsan),
      parking<ParkingBug::if_not_while>("m20", "if instead of while around a wait",
                                        usual("parked")),
      parking<ParkingBug::only_transition>("m21", "notifies on the first push only",
                                           usual("parked")),
      mutant<EventCounted<false>::Queue, EventCounted<true>::Queue>(
          "m23", "event count read relaxed: lost wake-up", usual("parked"), by_none,
          "store-load reordering in a window of nanoseconds, and only while the consumer parks"),
      parking<ParkingBug::silent_close>("m25", "closing wakes nobody",
                                        usual("parked-closed-early")),
      mutant<Mpsc<false>::Queue, Mpsc<true>::Queue>("m26", "nil instead of a sentinel",
                                                    usual("mpsc"), by_oracles),
      vyukov<VyukovBug::narrow>("m27", "sequence difference in eight bits",
                                with_capacity("mpsc", 256), by_oracles),
      vyukov<VyukovBug::boasts>("m28", "claims exact empty and lock-freedom", usual("renderer"),
                                by_oracles | by_progress),
      spsc<SpscBug::front_after_pop>("m30", "front() used after pop()", usual("tiny"),
                                     by_oracles | by_tsan),
      spsc<SpscBug::stale_tail>("m31", "cached index not refreshed", usual("bursts"), by_oracles),
      spsc<SpscBug::one_too_many>("m32", "place reused while the reader copies", usual("tiny"),
                                  by_oracles | by_tsan),
      spsc<SpscBug::plain_tail>("m34", "tail is a plain variable", usual("spsc"), by_tsan),
      stealing<DequeBug::take_unordered>("m35", "take without sequential consistency", thieves,
                                         by_oracles),
      stealing<DequeBug::relaxed_push>("m37", "push moves the bottom relaxed", usual("roles"),
                                       by_none,
                                       "a memory model: this processor keeps stores in order"),
      stealing<DequeBug::underflow>("m40", "unsigned index below zero", usual("roles"), by_oracles),
      stealing<DequeBug::last_without_cas>("m41", "last element taken without compare-and-swap",
                                           thieves, by_oracles),
      stealing<DequeBug::read_after_cas>("m42", "thief reads after it moved the top",
                                         usual("come-and-go"), by_oracles),
      stealing<DequeBug::steal_half>("m44", "thief takes half while the owner takes most", thieves,
                                     by_oracles),
      mutant<FramePool<false>::Queue, FramePool<true>::Queue>(
          "m46", "frame over while a task is being worked on", frame_end, by_oracles),
      mutant<Ticketed<false>::Queue, Ticketed<true>::Queue>(
          "m47", "who gives up leaves a ticket behind that nobody serves", usual("mpmc"),
          by_oracles),
      mutant<Overtaken<false>::Queue, Overtaken<true>::Queue>(
          "m48", "waits for a turn that has passed", usual("tiny"), by_oracles),
      mutant<ThesisLock, TwoLock<true>::Queue>("thesis-7.1", "the thesis' LOCK as printed",
                                               usual("mpmc"), by_oracles | by_tsan),
      mutant<ThesisLfree, Linked<LinkedBug::none>::Queue>(
          "thesis-7.3", "the thesis' LFREE as printed", usual("mpmc"), by_tsan | by_asan),
  };
  return table;
}

}  // namespace

std::span<const Mutant> mutants() {
  return all();
}

}  // namespace irt::stress
