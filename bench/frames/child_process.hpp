/// Work in a process of its own: whatever happens to it there, the caller goes on.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace irt {

/// How a child process ended.
struct Ending {
  std::string status = "ok";  ///< ok, hung, crashed or failed
  std::string message;        ///< of any other status: one line
  std::string answer;         ///< what it wrote to its standard output
};

/// Copies this process, which must have no other threads, and waits for the copy to do `work`.
/// There standard input reads `input`; what is written to standard output is the answer; `work` may
/// become another program. The copy *failed* where `work` throws or the exit code is not 0 or there
/// is no answer; it *crashed* where a signal ended it; it *hung*, and is killed, after `seconds`.
/// Its last line on standard error is part of the message. Ctrl-C does not reach it: where `cancel`
/// becomes true it is killed, and the ending means nothing.
///
/// Throws std::runtime_error where no process can be started.
Ending in_child(const std::string& input, double seconds, const std::atomic<bool>& cancel,
                const std::function<void()>& work);

}  // namespace irt
