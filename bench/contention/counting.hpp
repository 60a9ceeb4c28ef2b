/// Queues compiled once more so that they count what they do to shared memory (bench/counted).
///
/// Counting slows a queue down, and slower operations meet less often. So it is measured in
/// repetitions of its own, whose figures are reported beside the plain ones and never among them.
#pragma once

#include <string>
#include <string_view>

#include "bench/contention/subject.hpp"
#include "bench/counted/atomic_events.hpp"
#include "queues/registry.hpp"

namespace irt::contention {

/// Why there is no counting build of the queue `name`; empty where there is.
std::string not_countable(const QueueRegistry& queues, std::string_view name);

/// The counting build of the queue `name`, through its type-erased face. `not_countable` must be
/// empty.
SubjectMaker counting_subject_maker(const QueueRegistry& queues, std::string_view name);

/// What queues of a counting build have done in this thread since it began.
AtomicEvents events_of_this_thread();

}  // namespace irt::contention
