// The queues of tests/stress/cases on virtual cores.

#include "tests/stress/cases/call_result.hpp"
#include "tests/stress/cases/chase.hpp"
#include "tests/stress/cases/dropped_list.hpp"
#include "tests/stress/cases/dropped_ring.hpp"
#include "tests/stress/cases/element_kinds.hpp"
#include "tests/stress/cases/endless.hpp"
#include "tests/stress/cases/failed_growth.hpp"
#include "tests/stress/cases/handles.hpp"
#include "tests/stress/cases/healthy.hpp"
#include "tests/stress/cases/large_frames.hpp"
#include "tests/stress/cases/library_locks.hpp"
#include "tests/stress/cases/load_time.hpp"
#include "tests/stress/cases/many_sc.hpp"
#include "tests/stress/cases/many_steps.hpp"
#include "tests/stress/cases/mapped.hpp"
#include "tests/stress/cases/narrow_index.hpp"
#include "tests/stress/cases/notified_twice.hpp"
#include "tests/stress/cases/one_short.hpp"
#include "tests/stress/cases/patient.hpp"
#include "tests/stress/cases/proposed.hpp"
#include "tests/stress/cases/sanitizer_macro.hpp"
#include "tests/stress/cases/shared_line.hpp"
#include "tests/stress/cases/tagged_registry.hpp"
#include "tests/stress/cases/thread_keys.hpp"
#include "tests/stress/cases/traps.hpp"
#include "tests/stress/cases/unpublished.hpp"
#include "tests/stress/cases/waiting_pops.hpp"
#include "tests/stress/cases/waits_for_recycled.hpp"
#include "tests/stress/cases/walked_places.hpp"

namespace {

constexpr irt::QueueEntry entries[] = {
    irt::queue_entry<irt::WaitsForRecycledBug>("waits-for-recycled-bug"),
    irt::queue_entry<irt::WaitsForRecycledCountedBug>("waits-for-recycled-counted-bug"),
    irt::queue_entry<irt::WaitsForRecycledStoredBug>("waits-for-recycled-stored-bug"),
    irt::queue_entry<irt::WaitsForRecycledFixed>("waits-for-recycled-fixed"),
    irt::queue_entry<irt::OneShortBug>("one-short-bug"),
    irt::queue_entry<irt::OneShortProducersBug>("one-short-producers-bug"),
    irt::queue_entry<irt::OneShortUnorderedBug>("one-short-unordered-bug"),
    irt::queue_entry<irt::OneShortFixed>("one-short-fixed"),
    irt::queue_entry<irt::NarrowIndexBug>("narrow-index-bug"),
    irt::queue_entry<irt::NarrowIndex16Bug>("narrow-index-16-bug"),
    irt::queue_entry<irt::NarrowIndex32Bug>("narrow-index-32-bug"),
    irt::queue_entry<irt::NarrowIndexFixed>("narrow-index-fixed"),
    irt::queue_entry<irt::FailedGrowthBug>("failed-growth-bug"),
    irt::queue_entry<irt::FailedGrowthFixed>("failed-growth-fixed"),
    irt::queue_entry<irt::NotifiedTwiceBug>("notified-twice-bug"),
    irt::queue_entry<irt::NotifiedTwiceFixed>("notified-twice-fixed"),
    irt::queue_entry<irt::ClosedInTurn>("closed-in-turn"),
    irt::queue_entry<irt::TwoAtATime>("two-at-a-time"),
    irt::queue_entry<irt::TwoAtATimeForOne>("two-at-a-time-for-one"),
    irt::queue_entry<irt::TwoAtATimeForgets>("two-at-a-time-forgets-bug"),
    irt::queue_entry<irt::TwoAtATimeRaces>("two-at-a-time-races-bug"),
    irt::queue_entry<irt::DropsClosedBug>("drops-closed-bug"),
    irt::queue_entry<irt::RefusesTooSoonBug>("refuses-too-soon-bug"),
    irt::queue_entry<irt::WaitsSound>("waits"),
    irt::queue_entry<irt::FullInFlight>("full-in-flight"),
    irt::queue_entry<irt::WaitsImpatientBug>("waits-impatient-bug"),
    irt::queue_entry<irt::WaitsDeafBug>("waits-deaf-bug"),
    irt::queue_entry<irt::WaitsAcceptsBug>("waits-accepts-bug"),
    irt::queue_entry<irt::WaitsLeavesBehindBug>("waits-leaves-behind-bug"),
    irt::queue_entry<irt::PopsForEver>("pops-for-ever-bug"),
    irt::queue_entry<irt::ElementRingSound>("element-ring"),
    irt::queue_entry<irt::ElementRingTearsBug>("element-ring-tears-bug"),
    irt::queue_entry<irt::ElementRingTwiceBug>("element-ring-twice-bug"),
    irt::queue_entry<irt::ElementRingCountsEarlyBug>("element-ring-counts-early-bug"),
    irt::queue_entry<irt::Proposed>("proposed"),
    irt::queue_entry<irt::ProposedDeafBug>("proposed-deaf-bug"),
    irt::queue_entry<irt::BulkySound>("bulky"),
    irt::queue_entry<irt::BulkyDropsBug>("bulky-drops-bug"),
    irt::queue_entry<irt::BulkyBackwardsBug>("bulky-backwards-bug"),
    irt::queue_entry<irt::BulkyBoastsBug>("bulky-boasts-bug"),
    irt::queue_entry<irt::SharedLineBug>("shared-line-bug"),
    irt::queue_entry<irt::SharedLineFixed>("shared-line-fixed"),
    irt::queue_entry<irt::CallResultBug>("call-result-bug"),
    irt::queue_entry<irt::CallResultFixed>("call-result-fixed"),
    irt::queue_entry<irt::SanitizerMacroBug>("sanitizer-macro-bug"),
    irt::queue_entry<irt::UnpublishedBug>("unpublished-bug"),
    irt::queue_entry<irt::UnpublishedFixed>("unpublished-fixed"),
    irt::queue_entry<irt::DroppedListUsesBug>("dropped-list-uses-bug"),
    irt::queue_entry<irt::DroppedListLeaksBug>("dropped-list-leaks-bug"),
    irt::queue_entry<irt::DroppedListTwiceBug>("dropped-list-twice-bug"),
    irt::queue_entry<irt::DroppedListFixed>("dropped-list-fixed"),
    irt::queue_entry<irt::DroppedRingLooksBug>("dropped-ring-looks-bug"),
    irt::queue_entry<irt::DroppedRingWipesBug>("dropped-ring-wipes-bug"),
    irt::queue_entry<irt::DroppedRingFixed>("dropped-ring-fixed"),
    irt::queue_entry<irt::TriedMutexBag>("tried-mutex"),
    irt::queue_entry<irt::TriedSpinLockBag>("tried-spin-lock"),
    irt::queue_entry<irt::SleepingFlagBag>("sleeping-flag"),
    irt::queue_entry<irt::PolledFlagBag>("polled-flag"),
    irt::queue_entry<irt::GivesUpBug>("gives-up-bug"),
    irt::queue_entry<irt::GivesUpMutexBug>("gives-up-mutex-bug"),
    irt::queue_entry<irt::WaitsByTheClock>("waits-by-the-clock"),
    irt::queue_entry<irt::WalkedPlaces>("walked-places"),
    irt::queue_entry<irt::Chase>("chase"),
    irt::queue_entry<irt::ManySc>("many-sc"),
    irt::queue_entry<irt::ManySteps>("many-steps"),
    irt::queue_entry<irt::FewSteps>("few-steps"),
    irt::queue_entry<irt::EndlessWaitBug>("endless-wait-bug"),
    irt::queue_entry<irt::EndlessPauseBug>("endless-pause-bug"),
    irt::queue_entry<irt::EndlessYieldBug>("endless-yield-bug"),
    irt::queue_entry<irt::EndlessCallBug>("endless-call-bug"),
    irt::queue_entry<irt::EndlessRoundsBug>("endless-rounds-bug"),
    irt::queue_entry<irt::EndlessCount>("endless-count"),
    irt::queue_entry<irt::EndlessFixed>("endless-fixed"),
    irt::queue_entry<irt::ComputesAWhile>("computes-a-while"),
    irt::queue_entry<irt::ComputesLong>("computes-long"),
    irt::queue_entry<irt::TrapsBug>("traps-bug"),
    irt::queue_entry<irt::DividesBug>("divides-bug"),
    irt::queue_entry<irt::BreaksBug>("breaks-bug"),
    irt::queue_entry<irt::TrapsFixed>("traps-fixed"),
    irt::queue_entry<irt::Patient>("patient"),
    irt::queue_entry<irt::LoadTime>("load-time"),
    irt::queue_entry<irt::LoadTimeGrown>("load-time-grown"),
    irt::queue_entry<irt::TaggedTop>("tagged-top"),
    irt::queue_entry<irt::TaggedLow>("tagged-low"),
    irt::queue_entry<irt::TaggedInside>("tagged-inside"),
    irt::queue_entry<irt::TaggedBug>("tagged-bug"),
    irt::queue_entry<irt::LongSpin>("long-spin"),
    irt::queue_entry<irt::Registry>("registry"),
    irt::queue_entry<irt::ListQueue>("list-queue"),
    irt::queue_entry<irt::TimedMutexBag>("timed-mutex"),
    irt::queue_entry<irt::TimedSharedMutexBag>("timed-shared-mutex"),
    irt::queue_entry<irt::TimedReadWriteBag>("timed-rw-lock"),
    irt::queue_entry<irt::TimedSemaphoreBag>("timed-semaphore"),
    irt::queue_entry<irt::TimedStandardSemaphoreBag>("timed-std-semaphore"),
    irt::queue_entry<irt::TimedC11Bag>("timed-c11-mutex"),
    irt::queue_entry<irt::TimesOutMutexBug>("times-out-mutex-bug"),
    irt::queue_entry<irt::TimesOutReadWriteBug>("times-out-rw-lock-bug"),
    irt::queue_entry<irt::TimesOutSemaphoreBug>("times-out-semaphore-bug"),
    irt::queue_entry<irt::TimesOutC11Bug>("times-out-c11-bug"),
    irt::queue_entry<irt::MappedPages>("mapped-pages"),
    irt::queue_entry<irt::MappedAligned>("mapped-aligned"),
    irt::queue_entry<irt::MappedUsesBug>("mapped-uses-bug"),
    irt::queue_entry<irt::MappedAlignedUsesBug>("mapped-aligned-uses-bug"),
    irt::queue_entry<irt::MappedLeaksBug>("mapped-leaks-bug"),
    irt::queue_entry<irt::PosixKeyBag>("posix-key"),
    irt::queue_entry<irt::C11KeyBag>("c11-key"),
    irt::queue_entry<irt::PosixKeyLeaksBug>("posix-key-leaks-bug"),
    irt::queue_entry<irt::LargeFrames>("large-frames"),
    irt::queue_entry<irt::EndlessRecursionBug>("endless-recursion-bug"),
};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count);
extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count) {
  *count = sizeof entries / sizeof *entries;
  return entries;
}
