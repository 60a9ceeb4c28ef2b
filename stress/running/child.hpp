/// A forked process at the other end of a line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace irt {

/// A copy of this process that does some work and ends. It dies with its parent, even while it is
/// stopped; Ctrl-C does not reach it.
class Child {
 public:
  /// Copies this process, which must have no other threads, to do `work`, which gets the child's
  /// end of the line. The exit code is 0, or 1 where `work` throws, which standard error tells.
  /// Throws std::runtime_error where no process can be started.
  explicit Child(const std::function<void(int line)>& work);
  Child(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child& operator=(Child&&) = delete;
  /// Kills it if it still runs.
  ~Child();

  /// What it says can be read here, and it reads what is written; -1 after a `wait` for its end.
  [[nodiscard]] int line() const { return line_; }

  /// Sends it a signal; false where it has ended before.
  bool signal(int number) const;  // NOLINT(modernize-use-nodiscard)

  /// How it has ended, as `waitpid` says; nothing where it has not after `seconds`.
  std::optional<int> wait(double seconds);
  /// However long it takes.
  int wait();

  /// Holds all its threads; returns when none runs any more.
  void stop();

 private:
  bool has_ended(int options);

  pid_t process_ = -1;
  int line_ = -1;
  std::optional<int> status_;  // of waitpid, once it has ended
};

/// For the child: writes all, or ends it where nobody listens any more.
void say(int line, std::string_view bytes);

/// For the child: becomes the program `words[0]`, a path or a name to be looked for as a shell
/// does, with the other words as its arguments. Throws std::runtime_error where it cannot be
/// started.
[[noreturn]] void become(std::vector<std::string> words);

}  // namespace irt
