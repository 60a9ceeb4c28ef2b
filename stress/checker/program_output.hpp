/// What a checked program writes to its output, and the files that it opens.
#pragma once

#include <string>
#include <sys/types.h>

namespace irt::checker {

/// While this lives, standard input is empty, and what is written to the standard output and the
/// error output is kept instead of shown. Files that are opened meanwhile are closed by `afresh`.
class ProgramOutput {
 public:
  /// Throws std::runtime_error where there is no place to keep it.
  ProgramOutput();
  ProgramOutput(const ProgramOutput&) = delete;
  ProgramOutput& operator=(const ProgramOutput&) = delete;
  ~ProgramOutput();

  /// An execution begins: what the one before has left is gone.
  void afresh();
  /// What was written since.
  [[nodiscard]] std::string text() const;

  /// While this lives, outputs are as they were outside.
  class Pause {
   public:
    explicit Pause(ProgramOutput& output);
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;
    ~Pause();

   private:
    ProgramOutput& output_;
  };

 private:
  void take() const;
  void give_back() const;

  int kept_ = -1;                  ///< a file in memory
  int saved_[3] = {-1, -1, -1};    ///< the standard streams
  pid_t process_ = 0;              ///< in which ...
  unsigned first_of_program_ = 0;  ///< ... files from here on are the program's
};

}  // namespace irt::checker
