/// A finding for the reader: a sentence, a column per thread, the history, how to see it again.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/checker.hpp"
#include "stress/checker/queue_calls.hpp"
#include "stress/checker/values.hpp"
#include "stress/virtual_cores/symbols/symbols.hpp"

namespace irt::checker {

/// Those that were born: the others have nothing to show.
inline unsigned shown_threads(const Execution& execution) {
  return static_cast<unsigned>(execution.born().size());
}

/// What the event did: by its line of source, or as what a process does with its threads.
std::string described(const Execution& execution, const Event& event, Symbols& symbols,
                      Values& values, std::size_t width);

/// `text` with `name` of the places that {0}, {1}, ... stand for.
std::string with_places(std::string text, const std::vector<const void*>& places,
                        const std::function<std::string(const void*)>& name);
/// The finding's sentence with its places as file:line.
std::string sentence(const Finding& finding, Symbols& symbols);
/// Its kind and that, before the rest.
std::string heading(const Finding& finding, Symbols& symbols);

/// The steps of the execution that `execution` made last, as columns, with the plain accesses,
/// allocations and frees that its finding speaks of, and the blocks of the heap that are named.
/// Steps at places that only one thread touches are left out.
std::string columns(const Execution& execution, const std::vector<QueueCall>& operations,
                    Symbols& symbols);

/// Why an answer "empty" cannot be one of a FIFO queue, if one element shows it: "push 101 happens
/// before it, and nobody had taken that", else empty. Of an answer "full" what can have been inside
/// at most. Empty for other answers.
std::string contradiction(const QueueCall& answer, const std::vector<QueueCall>& operations);

/// Where each thread stands at the end of an execution that does not go on, and what it last saw.
std::string standings(const Execution& execution, Symbols& symbols);

/// The operations as lines with their intervals to scale: the scale is steps of this execution,
/// and only happens-before says what came first. A "full" outside of the columns that `wrong`, the
/// judge's sentence, speaks of is marked.
std::string history(const std::vector<QueueCall>& operations, std::string_view wrong);

/// All three, the second where threads do not go on.
std::string picture(const Execution& execution, const std::vector<QueueCall>& operations,
                    Symbols& symbols);

/// In a sentence.
std::string words(OnX86 answer);

/// The execution's graph in the language of Graphviz: program order, reads-from, and modification
/// order.
std::string dot(const Execution& execution, Symbols& symbols);

}  // namespace irt::checker
