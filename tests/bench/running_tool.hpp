/// A program of ours, running.
#pragma once

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "tests/bench/temporary.hpp"

namespace irt {

using Arguments = std::vector<std::string>;

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(contents(file));
}

class RunningTool {
 public:
  RunningTool(const char* program, Arguments arguments) {
    arguments.insert(arguments.begin(), program);
    std::fflush(stdout);  // or the copy would write what waits there once more
    child_ = fork();
    if (child_ != 0) return;
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    if (std::freopen((directory_ / "out").c_str(), "w", stdout) == nullptr ||
        std::freopen((directory_ / "err").c_str(), "w", stderr) == nullptr) {
      _exit(99);
    }
    execv(program, words.data());
    _exit(99);
  }
  void signal(int number) const { kill(child_, number); }

  /// Its exit code; 1000 more than the signal that ended it.
  [[nodiscard]] int wait() const {
    int status = 0;
    waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  [[nodiscard]] std::string out() const { return contents(directory_ / "out"); }
  [[nodiscard]] std::string err() const { return contents(directory_ / "err"); }

 private:
  TemporaryDirectory directory_;
  pid_t child_ = 0;
};

}  // namespace irt
