/// Keeps a process from being single-threaded.
#pragma once

#include <semaphore>
#include <thread>

namespace irt {

/// A thread that does nothing until this object goes. While a process has one thread only, glibc
/// takes locks and allocates without locked instructions, which a queue's users will not see.
class SecondThread {
 public:
  SecondThread() : thread_([this] { end_.acquire(); }) {}
  SecondThread(const SecondThread&) = delete;
  SecondThread& operator=(const SecondThread&) = delete;
  ~SecondThread() {
    end_.release();
    thread_.join();
  }

 private:
  std::binary_semaphore end_{0};
  std::thread thread_;
};

}  // namespace irt
