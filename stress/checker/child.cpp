#include "stress/checker/child.hpp"

#include <cstring>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace irt::checker {

using Forked = irt::Child;

Child::Child(const std::function<void(int line)>& work) try : Forked(work) {
} catch (const std::runtime_error& error) {
  throw std::runtime_error(std::string("cannot divide the work: ") + error.what() +
                           "; --jobs 1 needs no other process");
}

void Child::join(const std::string& name) {
  const int status = wait();
  if (WIFSIGNALED(status))
    throw std::runtime_error(name + " crashed: signal " + std::to_string(WTERMSIG(status)) + " (" +
                             strsignal(WTERMSIG(status)) +
                             "); that is a fault of the checker or of compiled code that the "
                             "queue calls; --jobs 1 runs in one process, for a debugger");
  if (WEXITSTATUS(status) == no_verdict) _exit(no_verdict);
  if (WEXITSTATUS(status) != 0)
    throw std::runtime_error(name + " ended with status " + std::to_string(WEXITSTATUS(status)) +
                             " and without a result");
}

}  // namespace irt::checker
