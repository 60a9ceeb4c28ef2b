/// Runs a suite in a child process, so that a crash or a hang is a finding and not the end.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "stress/threads/report.hpp"

namespace irt::stress {

/// The child's line to its parent. All methods may be called from any thread of the child.
class Messenger {
 public:
  explicit Messenger(int descriptor) : descriptor_(descriptor) {}

  void progress(std::uint64_t operations);
  void finding(const BrokenClaim& finding);
  void note(const std::string& sentence);
  void limit(const std::string& sentence);
  void figure(const std::string& name, const nlohmann::json& value);
  /// What is being tried from here on, one sentence: the evidence of a crash or a hang ends with
  /// it.
  void trying(const std::string& what);
  /// A hang: the stacks of the threads, by name; the parent finds their function names. Ends the
  /// process.
  [[noreturn]] void hang(const std::string& what, const nlohmann::json& stacks);

 private:
  void send(const nlohmann::json& message) const;

  int descriptor_;
};

/// Forks; the child runs `suite` and exits. Fills `result`, whose names are set, from what the
/// child says and from how it ends. `seconds` is what the suite was told to take: a child that is
/// silent for `patience` seconds longer is killed. `on_progress` is called with the operations so
/// far, several times a second. A race that ThreadSanitizer reports in a queue with fences gets a
/// second child and a second look (`strengthen_atomics`).
///
/// The calling process must have no other threads.
void run_in_child(Result& result, double seconds, double patience,
                  const std::function<void(Messenger&)>& suite,
                  const std::function<void(std::uint64_t)>& on_progress);

}  // namespace irt::stress
