// finds with -DWRONG: deadlock
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

class Worker {
 public:
  ~Worker() {
#if defined(WRONG)
    stop_ = true;  // it may just have looked, and not sleep yet
#else
    {
      const std::lock_guard held(lock_);
      stop_ = true;
    }
#endif
    changed_.notify_one();
    thread_.join();
  }

 private:
  void run() {
    std::unique_lock held(lock_);
    while (!stop_) changed_.wait(held);
  }

  std::mutex lock_;
  std::condition_variable changed_;
#if defined(WRONG)
  std::atomic<bool> stop_{false};
#else
  bool stop_ = false;
#endif
  std::thread thread_{[this] { run(); }};
};

int main() {
  const Worker worker;
  return 0;
}
