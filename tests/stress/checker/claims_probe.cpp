// Queues that keep their claims, and queues that do not, on virtual cores.

#include "tests/stress/cases/answers.hpp"
#include "tests/stress/cases/one_short.hpp"
#include "tests/stress/cases/roles.hpp"
#include "tests/stress/cases/unpublished.hpp"

namespace {

constexpr irt::QueueEntry entries[] = {
    irt::queue_entry<irt::OneShortBug>("one-short-bug"),
    irt::queue_entry<irt::OneShortProducersBug>("one-short-producers-bug"),
    irt::queue_entry<irt::OneShortUnorderedBug>("one-short-unordered-bug"),
    irt::queue_entry<irt::OneShortFixed>("one-short-fixed"),
    irt::queue_entry<irt::UnpublishedBug>("unpublished-bug"),
    irt::queue_entry<irt::UnpublishedFixed>("unpublished-fixed"),
    irt::queue_entry<irt::HalfBlindBug>("half-blind-bug"),
    irt::queue_entry<irt::HalfBlindFixed>("half-blind-fixed"),
    irt::queue_entry<irt::ShortAtFirstBug>("short-at-first-bug"),
    irt::queue_entry<irt::CreditedExact>("credited-exact"),
    irt::queue_entry<irt::CreditedInFlight>("credited-in-flight"),
    irt::queue_entry<irt::HoardingBoast>("hoarding-boast"),
    irt::queue_entry<irt::HoardingHonest>("hoarding-honest"),
    irt::queue_entry<irt::LeavesOne>("leaves-one"),
    irt::queue_entry<irt::Picky>("picky"),
    irt::queue_entry<irt::KnowsItsWorkers>("knows-its-workers"),
    irt::queue_entry<irt::KnowsItsConsumer>("knows-its-consumer"),
    irt::queue_entry<irt::KnowsEachWorker>("knows-each-worker"),
};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count) {
  *count = sizeof entries / sizeof *entries;
  return entries;
}
