/// What came out of a check, in lines for the reader.
#pragma once

#include <string>
#include <string_view>

#include "stress/checker/queue_check.hpp"

namespace irt::checker {

/// What the exhaustive search is called when a clock orders the calls, and when memory may run out.
inline constexpr const char* timed_search = "real time";
inline constexpr const char* poor_search = "no memory";
/// Threads are stopped for good. No search for proofs.
inline constexpr const char* stalls_search = "stalls";

std::string_view name_of(Origin origin);

/// Whether its search leaves nothing out when it comes to its end.
bool searched_whole(const ShapeResult& shape);

/// How far a search is, on the error output.
void say(std::string_view shape, std::string_view search, const SearchProgress& now);

/// Adds what came of one shape or, where executions differ, what is left of that; unless `quiet`,
/// its line goes to the output.
void add(QueueResult& all, ShapeResult shape, bool quiet);

/// One line for all shapes of an origin, and why some are not proved.
void say(Origin origin, const QueueResult& result);

/// The whole in a few sentences: what was proved, what was not, and why.
std::string verdict(std::string_view queue, const QueueResult& result);

}  // namespace irt::checker
