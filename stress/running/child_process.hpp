/// Work in a process of its own: whatever happens to it there, the caller goes on.
#pragma once

#include <atomic>
#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "stress/running/child.hpp"

namespace irt {

/// How a child process ended.
struct Ending {
  std::string status;   ///< ok, hung, crashed or failed
  std::string message;  ///< of any other status: one line
  std::string answer;   ///< what it said and nobody took before
  int signal;           ///< that ended it
  int code;             ///< its exit code, where none did
  std::string errors;   ///< what it wrote to its standard error
};

/// A child process that is spoken to in lines while it works.
class ChildProcess {
 public:
  /// As `Child`; `work` may become another program. Its standard error is kept for `end`.
  explicit ChildProcess(const std::function<void(int line)>& work);

  /// Writes to the line; nothing happens where it has ended.
  void tell(std::string_view text) const;

  /// The next line that it says, without its end. Nothing where the child ends before, and where it
  /// is killed: for having been silent for `seconds`, or because `cancel` became true.
  std::optional<std::string> line(double seconds, const std::atomic<bool>& cancel);

  /// Waits until it has ended; kills it after `seconds` or when `cancel` becomes true, in which
  /// case the ending means nothing. The child *failed* where `work` threw or the exit code was not
  /// 0 or there is no answer; it *crashed* where a signal ended it; it *hung* where it was killed.
  /// Its last line on standard error is part of the message.
  Ending end(double seconds, const std::atomic<bool>& cancel);

  /// Holds all its threads; returns when none runs any more.
  void stop() { child_.stop(); }
  /// Lets them go on.
  void go_on() const { child_.signal(SIGCONT); }

 private:
  struct File {
    File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File();
    int descriptor;
  };

  bool read_more(double seconds, const std::atomic<bool>& cancel);
  void kill_for_silence(double seconds);

  File errors_;
  Child child_;
  std::string text_;              // that was said and not yet taken
  std::optional<double> silent_;  // seconds, for which it was killed
};

/// For `work`: makes the line its standard input and output.
void speak_by_standard_streams(int line);

/// A child that is not spoken to: does `work`, whose result is its answer, and is waited for. What
/// it prints is as if on standard error.
Ending in_child(double seconds, const std::atomic<bool>& cancel,
                const std::function<std::string()>& work);

}  // namespace irt
