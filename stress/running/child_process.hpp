/// Work in a process of its own: whatever happens to it there, the caller goes on.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>

namespace irt {

/// How a child process ended.
struct Ending {
  std::string status = "ok";  ///< ok, hung, crashed or failed
  std::string message;        ///< of any other status: one line
  std::string answer;         ///< what it wrote to its standard output and nobody took before
};

/// A child process that is spoken to while it works. It dies with its parent, even while it is
/// stopped; Ctrl-C does not reach it.
class ChildProcess {
 public:
  /// Copies this process, which must have no other threads, to do `work` there. Standard input and
  /// output are the caller's to write and read; `work` may become another program. Throws
  /// std::runtime_error where no process can be started.
  explicit ChildProcess(const std::function<void()>& work);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it if it still runs.
  ~ChildProcess();

  /// Writes to its standard input; nothing happens where it has ended.
  void tell(std::string_view text) const;

  /// The next line of its standard output, without its end. Nothing where the child ends before,
  /// and where it is killed: for having been silent for `seconds`, or because `cancel` became true.
  std::optional<std::string> line(double seconds, const std::atomic<bool>& cancel);

  /// Waits until it has ended; kills it after `seconds` or when `cancel` becomes true, in which
  /// case the ending means nothing. The child *failed* where `work` threw or the exit code was not
  /// 0 or there is no answer; it *crashed* where a signal ended it; it *hung* where it was killed.
  /// Its last line on standard error is part of the message.
  Ending end(double seconds, const std::atomic<bool>& cancel);

  /// Holds all its threads; returns when none runs any more.
  void stop();
  /// Lets them go on.
  void go_on() const;

 private:
  bool read_more(double seconds, const std::atomic<bool>& cancel);
  void kill_for_silence(double seconds);

  pid_t process_ = -1;
  int socket_ = -1, errors_ = -1;
  std::string text_;              // that was written and not yet taken
  std::optional<int> status_;     // of waitpid, once it has ended
  std::optional<double> silent_;  // seconds, for which it was killed
};

/// A child that is not spoken to: does `work`, and is waited for.
Ending in_child(double seconds, const std::atomic<bool>& cancel, const std::function<void()>& work);

}  // namespace irt
