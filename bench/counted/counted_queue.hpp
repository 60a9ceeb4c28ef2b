/// Queues that count their own atomic operations, without a change to their source.
///
/// The queue's header is compiled once more with -fsanitize=thread, which turns each atomic
/// operation into a call; in place of the sanitizer stands a runtime that does the operation and
/// counts it for the thread (bench/counted/atomic_events.hpp). What compiled libraries do is not
/// seen, the C library's mutex among it. Counting slows a queue down, and slower operations meet
/// less often; so a counted run is reported beside a plain one and never in its place.
#pragma once

#include <string_view>

#include "queues/registry.hpp"

namespace irt {

/// The queue `name`, counting; nullptr where it was not built to count (`ModuleKind::counted`).
/// Valid until the process ends.
const QueueEntry* counted_queue(const QueueRegistry& queues, std::string_view name);

}  // namespace irt
