/// Whether a queue publishes what its elements point to.
///
/// That is plain memory which nothing else touches: it was written when the thread had made the
/// events that the push was called after, and is read after the pop. So there is a race exactly if
/// the push's first event does not happen before that, and no memory is needed to tell.
#pragma once

#include <cstdint>
#include <string>

namespace irt::checker {

/// Whether what `pusher` did before the push that it called after `called` events of its own
/// happens before what the thread in progress does now; true where races are no findings.
bool sees_what_precedes(unsigned pusher, std::uint16_t called);

/// Ends the execution with that data race. `element` is how the element is called.
[[noreturn]] void report_unpublished(const std::string& element, unsigned pusher,
                                     std::uint16_t called);

}  // namespace irt::checker
