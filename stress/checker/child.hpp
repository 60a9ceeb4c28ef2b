/// A forked process that sends what it finds to its parent.
///
/// The state of virtual cores is global to a process, so searches that go on beside each other are
/// children.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <sys/types.h>

namespace irt::checker {

/// The exit code of a process that can say nothing of the code it was to look at, and has said why.
inline constexpr int no_verdict = 3;

class Child {
 public:
  /// `work` gets the end of the pipe to write to; the child ends with it. Throws std::runtime_error
  /// if there can be no process.
  explicit Child(const std::function<void(int pipe)>& work);
  Child(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child& operator=(Child&&) = delete;
  /// Ends it, whatever it does.
  ~Child();

  /// What it sends can be read here; -1 after `join`.
  [[nodiscard]] int pipe() const { return pipe_; }

  /// After the last that it has sent. Throws std::runtime_error, which calls it `name`, if it did
  /// not end well; ends this process, too, if it could give no verdict and has said why.
  void join(const std::string& name);

 private:
  void close_pipe();

  pid_t process_ = -1;
  int pipe_ = -1;
};

/// For the child: writes all, or ends it.
void send_bytes(int pipe, const void* bytes, std::size_t size);

}  // namespace irt::checker
