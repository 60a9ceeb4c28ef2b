/// Queues that count their own atomic operations, without a change to their source.
///
/// The queue's header is compiled once more with -fsanitize=thread, which turns each atomic
/// operation into a call; in place of the sanitizer stands a runtime that does the operation and
/// counts it for the thread (bench/counted/atomic_events.hpp). What compiled libraries do is not
/// seen, the C library's mutex among it. Counting slows a queue down, and slower operations meet
/// less often; so a counted run is reported beside a plain one and never in its place.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

/// Adds the queue NAME of the plug-in `file`, NAME.so, if irt_add_plugin() built it to count, too:
/// then NAME.counted.so lies beside it.
void add_counted_plugin(const std::filesystem::path& file);

/// The names of the queues that were built to count.
std::vector<std::string> counted_queues();

/// The queue `name`, counting; nullptr where it was not built. Valid until the process ends.
const QueueEntry* counted_queue(std::string_view name);

}  // namespace irt
