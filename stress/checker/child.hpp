/// A forked process that sends what it finds to its parent.
///
/// The state of virtual cores is global to a process, so searches that go on beside each other are
/// children.
#pragma once

#include <functional>
#include <string>

#include "stress/running/child.hpp"

namespace irt::checker {

/// The exit code of a process that can say nothing of the code it was to look at, and has said why.
inline constexpr int no_verdict = 3;

class Child : public irt::Child {
 public:
  /// Throws std::runtime_error if there can be no process.
  explicit Child(const std::function<void(int line)>& work);

  /// After the last that it has sent. Throws std::runtime_error, which calls it `name`, if it did
  /// not end well; ends this process, too, if it could give no verdict and has said why.
  void join(const std::string& name);
};

}  // namespace irt::checker
